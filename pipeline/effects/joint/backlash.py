"""Backlash in a joint's gear."""

from simgap.effects.backlash import Backlash


class JointBacklash(Backlash):
    """The motor crosses a gap after each reversal before it drives the axis."""

    kind = "joint"
    acts_on = "actuator"
    needs = ("velocity", "effort")
    transmitted = "effort"
    gaps = (0.001, 0.004, 0.015, 0.06)
    sentence = (
        "The gear has {gap} {gap_unit} of play, with a fraction {motor_inertia_share} of the inertia on the "
        "motor's side; add backlash to the simulator."
    )
    look_alikes = ("command_delay", "dead_zone", "hysteresis")
