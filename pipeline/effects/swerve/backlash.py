"""Play in the steering gears of a swerve drive."""

from simgap.effects.backlash import Backlash


class SteerBacklash(Backlash):
    """After each reversal a steering motor crosses the play of its gears before the module feels it."""

    kind = "swerve"
    acts_on = "steer"
    group = "steer_"
    transmitted = "steer_torque"
    sentence = (
        "There are {gap} rad of play between each steering motor and its module, and {motor_inertia_share} of the "
        "inertia is on the motor's side; add backlash to the steering."
    )
