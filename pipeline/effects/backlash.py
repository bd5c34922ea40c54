"""Play between a motor and the axis that it drives, shared by joints and swerve drives.

The recorded motion is the load's. The motor's hidden place in the gap and its speed through it follow from its own
inertia; the nominal inertia is that of both together. A face is left when the effort turns round, and met without
rebound, so that the motor hands over the momentum that it gathered in the gap.
"""

from typing import Any, ClassVar

import torch
from torch import Tensor

from pipeline.effects.effect import ActuatorEffect, Parameter, Signals, Values
from pipeline.effects.scan import scan


class Backlash(ActuatorEffect):
    """Two bodies with a gap between them: after each reversal the motor crosses it before the axis feels it."""

    group: ClassVar[str] = ""
    """What the names of signals and constants begin with: a swerve's `steer_`."""
    transmitted: ClassVar[str]
    """The signal that crosses the gap: effort or torque."""

    remembers = True
    order = 2
    name = "backlash"
    parameters = (
        Parameter("gap", "rad", 0.02, 0.0, 1.0),
        Parameter("motor_inertia_share", "1", 0.3, 0.01, 0.99, neutral=0.5),
    )
    formula = (
        "transmitted = effort − J·d(slip)/dt, J = motor_inertia_share · inertia; in the gap the motor moves alone, "
        "J·d(velocity + slip)/dt = effort; |∫ slip dt| ≤ gap / 2"
    )
    source = "Nordin & Gutman 2002, Controlling mechanical systems with backlash: a survey (Automatica 38)"
    excitation = "reverse the effort often, gently and hard, with little else on the axis"

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: the gap has to be about right before its crossings meet the recorded ones."""
        return scan(gap=(0.002, 0.01, 0.03, 0.1), motor_inertia_share=(0.1, 0.4, 0.8))

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Tensor], Any]:
        """Return the effort that reaches the axis; the memory holds place, slip and the axis's last velocity."""
        effort, velocity = signals[self.transmitted], signals[f"{self.group}velocity"]
        half, inertia = 0.5 * values["gap"], values["motor_inertia_share"] * constants[f"{self.group}inertia"]
        if memory is None:
            memory = half * torch.sign(effort), torch.zeros_like(effort), velocity
        place, slip, velocity_before = memory
        braking = self._back_emf(constants) if f"{self.group}voltage" in signals else 0.0
        # On a face the motor goes with the axis; what the axis does counts only in the gap.
        left_behind = torch.where(place.abs() < half, velocity - velocity_before, 0.0)
        pushed = slip + time_step * effort / inertia - left_behind
        alone = pushed / (1.0 + time_step * braking / inertia)
        moved = (place + time_step * alone).clamp(-half, half)
        now = (moved - place) / time_step
        transmitted = effort - braking * now - inertia * (now - slip) / time_step
        return {self.transmitted: transmitted}, (moved, now, velocity)

    def _back_emf(self, constants: Values) -> Any:
        """Return what a motor that runs ahead of the axis loses in effort per speed, N·m·s/rad."""
        torque_constant = constants[f"{self.group}torque_constant"]
        back_emf_constant = constants.get(f"{self.group}back_emf_constant", torque_constant)
        geared = constants[f"{self.group}gear_ratio"] ** 2
        return geared * torque_constant * back_emf_constant / constants[f"{self.group}resistance"]
