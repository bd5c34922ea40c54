"""Dead zone in the command of a joint.

It acts on the voltage if there is one, otherwise on the effort, or on the error of a servo that is told a position. Its
width is an effort in all cases: that of the motor at standstill.
"""

from typing import Any

from simgap.effects.effect import CommandEffect, Parameter, Signals, Values
from simgap.effects.joint.common import commanded
from simgap.physics.shapes import Signal


class DeadZone(CommandEffect):
    """The drive ignores small commands and reduces all larger ones by the same amount."""

    name = "dead_zone"
    kind = "joint"
    acts_on = "command"
    parameters = (Parameter("width", "N·m", 0.1, 0.0, 1e6),)
    formula = (
        "command_effective = sign(command) · max(|command| − width / gain, 0), gain = torque_constant · gear_ratio / "
        "resistance for a voltage, 1 for an effort, proportional for the error of a position"
    )
    source = "Tao & Kokotović 1994, Adaptive control of plants with unknown dead-zones (IEEE Trans. Autom. Control 39)"
    sentence = (
        "The drive ignores commands below {width} {width_unit} at standstill; add a dead zone to the "
        "simulator."
    )
    excitation = (
        "ramp the command slowly through zero in both directions while something else also moves the axis"
    )
    symptom = "Small commands around zero have no effect, even while the axis moves."
    look_alikes = ("coulomb_friction",)

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the command beyond the dead zone."""
        name = commanded(signals)
        rest = signals["position"] if name == "position_command" else 0.0
        command, width = signals[name] - rest, values["width"] / _gain(name, constants)
        return {name: rest + command - command.clamp(-width, width)}, None


def _gain(command: str, constants: Values) -> Any:
    """Return the motor's effort at standstill per unit of a command."""
    if command == "effort":
        return 1.0
    if command == "position_command":
        return constants["proportional"]
    return constants["torque_constant"] * constants["gear_ratio"] / constants["resistance"]
