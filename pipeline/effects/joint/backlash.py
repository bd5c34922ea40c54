"""Play between a joint's motor and the axis that it drives."""

from simgap.effects.backlash import Backlash


class JointBacklash(Backlash):
    """Two bodies with a gap between them: after each reversal the motor crosses it before the axis feels it."""

    kind = "joint"
    acts_on = "actuator"
    needs = ("velocity", "effort")
    transmitted = "effort"
    sentence = (
        "There are {gap} {gap_unit} of play between motor and axis, and {motor_inertia_share} of the inertia is on the "
        "motor's side; add backlash."
    )
