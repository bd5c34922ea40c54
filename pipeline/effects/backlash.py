"""Backlash between a motor and the axis that it drives, for joints and swerve steering.

The recorded motion is that of the load. The motor's position in the gap and its speed across it are hidden states.
They follow from the motor's own inertia; the nominal inertia is that of motor and load together. The motor leaves a
face when the effort reverses. It meets the other face without rebound and passes on the momentum that it gained in
the gap.
"""

from typing import Any, ClassVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.scan import scan
from simgap.physics.shapes import Signal
from simgap.physics.tracing import may_run_compiled

Array = NDArray[Any]

FREE_INERTIA = "free_inertia"
"""Signal: the share of an axis' inertia that moves by itself, because its motor is inside the gap."""
_ON_A_FACE = 1e-6
"""Of half the gap: rounding of a sum over a block."""


class Backlash(ActuatorEffect):
    """The motor crosses a gap after each reversal before it drives the load."""

    group: ClassVar[str] = ""
    """Prefix of the names of signals and constants: `steer_` for a swerve drive."""
    transmitted: ClassVar[str]
    """The signal that crosses the gap: effort or torque."""
    gaps: ClassVar[tuple[float, ...]] = (0.002, 0.01, 0.03, 0.1)
    """Where a fit of the gap starts, rad, or in the size of the travel."""

    remembers = True
    smooths_commands = True
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
    excitation = "reverse the effort often, gently and hard, with little other load on the axis"
    symptom = "After each reversal of the effort the axis pauses for a moment, then moves with a jolt."

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a fit needs a gap whose crossings overlap the recorded ones."""
        return scan(gap=self.gaps, motor_inertia_share=(0.1, 0.4, 0.8))

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the effort that reaches the axis; the memory holds place, slip and the axis's last velocity."""
        effort, velocity = signals[self.transmitted], signals[f"{self.group}velocity"]
        half, inertia, braking = self._motor(signals, values, constants)
        if memory is None:
            memory = half * torch.sign(effort), torch.zeros_like(effort), velocity
        place, slip, velocity_before = memory
        push, turn = time_step / inertia * effort, velocity - velocity_before
        damped = 1.0 / (1.0 + time_step * braking / inertia)
        moved, now = _crossed(place, slip, push, turn, half, damped, time_step)
        reaches = effort - _kept(now, slip, inertia, braking, time_step)
        free = values["motor_inertia_share"] * _inside(moved, half).to(effort.dtype)
        return {self.transmitted: reaches, f"{self.group}{FREE_INERTIA}": free}, (moved, now, velocity)

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Return blocks with the effort that reaches the axis.

        The gap needs a loop over samples. A compiled loop runs on the processor if no gradients are asked for.
        """
        effort, velocity = signals[self.transmitted], signals[f"{self.group}velocity"]
        half, inertia, braking = self._motor(signals, values, constants)
        if not may_run_compiled((effort, velocity), (half, inertia, braking)):
            return super().along_time(signals, values, constants, time_step)
        slips = torch.from_numpy(_slips(effort.numpy(), velocity.numpy(), half, inertia, braking, time_step))
        before = torch.cat([torch.zeros_like(slips[:, :1]), slips[:, :-1]], dim=1)
        kept = _kept(slips, before, inertia, braking, time_step)
        place = half * torch.sign(effort[:, :1]) + time_step * slips.cumsum(1)
        free = values["motor_inertia_share"] * _inside(place, half).to(effort.dtype)
        return {**signals, self.transmitted: effort - kept, f"{self.group}{FREE_INERTIA}": free}

    def _motor(self, signals: Signals, values: Values, constants: Values) -> tuple[Any, Any, Any]:
        """Return half the gap, the motor's inertia at the axis and its damping in the gap."""
        inertia = values["motor_inertia_share"] * constants[f"{self.group}inertia"]
        braking = self._back_emf(constants) if f"{self.group}voltage" in signals else 0.0
        return 0.5 * values["gap"], inertia, braking

    def _back_emf(self, constants: Values) -> Any:
        """Return the back-EMF damping of the motor at the axis, N·m·s/rad."""
        torque_constant = constants[f"{self.group}torque_constant"]
        back_emf_constant = constants.get(f"{self.group}back_emf_constant", torque_constant)
        geared = constants[f"{self.group}gear_ratio"] ** 2
        return geared * torque_constant * back_emf_constant / constants[f"{self.group}resistance"]


def _crossed(
    place: Any, slip: Any, push: Any, turn: Any, half: Any, damped: Any, time_step: float
) -> tuple[Any, Any]:
    """Return the motor's position in the gap a step later and its speed relative to the axis.

    On a face the motor moves with the axis; the axis's own change (`turn`) counts only inside the gap.
    """
    alone = (slip + push - (abs(place) < half) * turn) * damped
    moved = (place + time_step * alone).clip(-half, half)
    return moved, (moved - place) / time_step


def _inside(place: Tensor, half: Any) -> Tensor:
    """Return where a motor is inside the gap, not on a face of it."""
    return place.abs() < half * (1.0 - _ON_A_FACE)


def _kept(now: Any, before: Any, inertia: Any, braking: Any, time_step: float) -> Any:
    """Return the effort that the motor's own inertia and back-EMF absorb while its slip changes."""
    return braking * now + inertia * (now - before) / time_step


def _slips(
    effort: Array, velocity: Array, half: float, inertia: float, braking: float, time_step: float
) -> Array:
    """Return the motor's speed relative to the axis, (blocks, samples, ...)."""
    from simgap.physics.play_steps import slips_in_play  # its import takes longer than all effects

    damped = 1.0 / (1.0 + time_step * braking / inertia)
    push = time_step / inertia * _by_motor(effort)
    turn = np.diff(_by_motor(velocity), axis=1, prepend=_by_motor(velocity)[:, :1])
    place = half * np.sign(push[:, 0])
    slips = slips_in_play(place, push, turn, float(half), float(damped), time_step)
    blocks, samples, *axes = effort.shape
    apart = np.moveaxis(slips.reshape(blocks, *axes, samples), -1, 1)
    return np.ascontiguousarray(apart, dtype=effort.dtype)


def _by_motor(series: Array) -> Array:
    """Return series (blocks, samples, ...) as rows, (blocks · ..., samples)."""
    return np.ascontiguousarray(np.moveaxis(series, 1, -1).reshape(-1, series.shape[1]), dtype=np.float64)
