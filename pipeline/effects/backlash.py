"""Play between a motor and the axis that it drives, shared by joints and swerve drives.

The recorded motion is the load's. The motor's hidden place in the gap and its speed through it follow from its own
inertia; the nominal inertia is that of both together. A face is left when the effort turns round, and met without
rebound, so that the motor hands over the momentum that it gathered in the gap.
"""

from typing import Any, ClassVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from pipeline.effects.effect import ActuatorEffect, Parameter, Signals, Values
from pipeline.effects.scan import scan

Array = NDArray[Any]


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
        half, inertia, braking = self._motor(signals, values, constants)
        if memory is None:
            memory = half * torch.sign(effort), torch.zeros_like(effort), velocity
        place, slip, velocity_before = memory
        # On a face the motor goes with the axis; what the axis does counts only in the gap.
        left_behind = torch.where(place.abs() < half, velocity - velocity_before, 0.0)
        pushed = slip + time_step * effort / inertia - left_behind
        alone = pushed / (1.0 + time_step * braking / inertia)
        moved = (place + time_step * alone).clamp(-half, half)
        now = (moved - place) / time_step
        transmitted = effort - braking * now - inertia * (now - slip) / time_step
        return {self.transmitted: transmitted}, (moved, now, velocity)

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Tensor]:
        """Return blocks with the effort that reaches the axis: `actuate` in NumPy, where nothing asks for gradients.

        A gap can only be gone through sample by sample, and NumPy's calls cost a fifth of torch's.
        """
        effort, velocity = signals[self.transmitted], signals[f"{self.group}velocity"]
        half, inertia, braking = self._motor(signals, values, constants)
        if any(isinstance(value, Tensor) for value in (half, inertia, braking)) or effort.requires_grad:
            return super().along_time(signals, values, constants, time_step)
        slips = torch.from_numpy(_slips(effort.numpy(), velocity.numpy(), half, inertia, braking, time_step))
        before = torch.nn.functional.pad(slips.movedim(1, -1)[..., :-1], (1, 0)).movedim(-1, 1)
        transmitted = effort - braking * slips - inertia * (slips - before) / time_step
        return {**signals, self.transmitted: transmitted}

    def _motor(self, signals: Signals, values: Values, constants: Values) -> tuple[Any, Any, Any]:
        """Return half the gap, the motor's inertia at the axis and what brakes it in the gap."""
        inertia = values["motor_inertia_share"] * constants[f"{self.group}inertia"]
        braking = self._back_emf(constants) if f"{self.group}voltage" in signals else 0.0
        return 0.5 * values["gap"], inertia, braking

    def _back_emf(self, constants: Values) -> Any:
        """Return what a motor that runs ahead of the axis loses in effort per speed, N·m·s/rad."""
        torque_constant = constants[f"{self.group}torque_constant"]
        back_emf_constant = constants.get(f"{self.group}back_emf_constant", torque_constant)
        geared = constants[f"{self.group}gear_ratio"] ** 2
        return geared * torque_constant * back_emf_constant / constants[f"{self.group}resistance"]


def _slips(
    effort: Array, velocity: Array, half: float, inertia: float, braking: float, time_step: float
) -> Array:
    """Return how fast the motor runs ahead of the axis, (blocks, samples, ...)."""
    damped = 1.0 / (1.0 + time_step * braking / inertia)
    pushes = np.moveaxis(time_step / inertia * effort, 1, 0)
    turns = np.moveaxis(np.diff(velocity, axis=1, prepend=velocity[:, :1]), 1, 0)
    slips = np.empty(pushes.shape, dtype=effort.dtype)
    place, slip = half * np.sign(effort[:, 0]), np.zeros_like(effort[:, 0])
    for sample, (push, turn) in enumerate(zip(pushes, turns, strict=True)):
        alone = (slip + push - (np.abs(place) < half) * turn) * damped
        moved = np.minimum(np.maximum(place + time_step * alone, -half), half)
        slip = (moved - place) / time_step
        place, slips[sample] = moved, slip
    return np.ascontiguousarray(np.moveaxis(slips, 0, 1))
