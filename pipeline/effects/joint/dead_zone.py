"""Commands too small for a joint's drive to act on.

It acts on the voltage where there is one, else on the effort; the width is in that command's unit.
"""

from typing import Any

from torch import Tensor

from pipeline.effects.effect import CommandEffect, Parameter, Signals, Values


class DeadZone(CommandEffect):
    """A band of commands around zero does nothing, and all others are smaller by it."""

    name = "dead_zone"
    kind = "joint"
    acts_on = "command"
    parameters = (Parameter("width", "V", 0.5, 0.0, 1e4),)
    yields_to = ("coulomb_friction",)
    formula = "command_effective = sign(command) · max(|command| − width, 0)"
    source = "Tao & Kokotović 1994, Adaptive control of plants with unknown dead-zones (IEEE Trans. Autom. Control 39)"
    sentence = "The drive ignores commands below {width} {width_unit}; add a dead zone to the simulator."
    excitation = (
        "slow command ramps through zero in both directions, on an axis that is also pushed otherwise"
    )

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Tensor], Any]:
        """Return the command less what the dead zone takes of it."""
        name = "voltage" if "voltage" in signals else "effort"
        command, width = signals[name], values["width"]
        return {name: command - command.clamp(-width, width)}, None
