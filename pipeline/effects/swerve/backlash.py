"""Backlash in the steering gears of a swerve drive."""

from simgap.effects.backlash import Backlash


class SteerBacklash(Backlash):
    """A steering motor crosses a gap after each reversal before it turns the module."""

    kind = "swerve"
    acts_on = "steer"
    group = "steer_"
    transmitted = "steer_torque"
    sentence = (
        "The steering gears have {gap} rad of play, with a fraction {motor_inertia_share} of the inertia on "
        "the motor's side; add backlash to the steering."
    )
    look_alikes = ("command_delay",)
