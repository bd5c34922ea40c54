"""Flexible coupling between the motor and the load of a joint: two masses, a spring and a damper.

The recorded motion is that of the load, as it is for `backlash`. The motor's position and velocity are a hidden state.
They follow from the effort and from the recorded motion of the load, which winds the spring:

    J_m · d(v_m)/dt = effort − b · (v_m − v) − transmitted,    J_l · dv/dt = transmitted − loads

with b the back-EMF's damping, since the nominal effort is that of a motor which turns with the load. The nominal
equation has the inertia of both: the effort in it is what the shaft transmits and J_m · dv/dt. Noise of the recorded
motion then counts as it does without the effect. Within a step the effort is held and
the load moves on at its velocity; for this the solution is exact, at any stiffness. A share of zero stands for a rigid
coupling.
"""

from typing import Any

import torch
from torch import Tensor

from simgap.effects.chain import chains_of
from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.recurrence import accumulated_states
from simgap.effects.scan import scan
from simgap.physics.shapes import Signal

_LEAST_SHARE = 1e-3  # of the inertia, in the motor's equation: a lighter motor turns as the spring lets it
_TOGETHER = 16  # blocks over which a vibration goes on: it outlasts the margin of one


class FlexibleCoupling(ActuatorEffect):
    """A springy shaft or belt couples motor and load, and the load is what is recorded."""

    remembers = True
    order = 2
    name = "flexible_coupling"
    # Its hidden motor is driven by the recorded motion, so that it follows noise and whatever else is in that motion:
    # beside it no other law is seen. It serves a simulator whose shaft is known.
    names_physics = False
    kind = "joint"
    acts_on = "actuator"
    parameters = (
        Parameter("frequency", "Hz", 8.0, 0.2, 500.0, neutral=500.0),
        Parameter("damping_ratio", "1", 0.05, 0.0, 2.0, neutral=0.5),
        Parameter("motor_inertia_share", "1", 0.4, 0.0, 0.95),
    )
    needs = ("position", "velocity", "effort")
    formula = (
        "transmitted = k · (q_m − q) + c · d(q_m − q)/dt, J_m · d²(q_m)/dt² = effort − transmitted, "
        "J_m = motor_inertia_share · inertia; of the load against the held motor k = J_l · (2π · frequency)², "
        "c = 2 · damping_ratio · J_l · 2π · frequency"
    )
    source = "Spong 1987, Modeling and control of elastic joint robots (ASME J. Dyn. Syst. 109)"
    sentence = (
        "Motor and load are coupled by a spring: against a held motor the load swings at {frequency} Hz with a damping "
        "ratio of {damping_ratio}, and a fraction {motor_inertia_share} of the inertia is on the motor's side; add a "
        "flexible coupling to the simulator."
    )
    excitation = "run a chirp through the resonance, and stop abruptly and let the load swing out"
    symptom = "After a step of the effort the load rings at a fixed frequency, at rest too."
    look_alikes = ("backlash", "motor_lag", "command_delay")

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan over the frequency: each swing gained or lost gives a local minimum."""
        return scan(
            frequency=(2.0, 4.0, 8.0, 16.0, 32.0), damping_ratio=(0.1,), motor_inertia_share=(0.2, 0.6)
        )

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the mean effort that the shaft transmits over the step.

        The position and velocity of the load are those at the start of the step. The memory holds the motor's state
        and that velocity. What follows the motion within a step is the back-EMF of a motor that turns with the load;
        the shaft does not transmit it at once, and its mean is taken out again. The acceleration that carries the
        motor's inertia is that of the step before, and what the change of the shaft's effort adds to it.
        """
        effort, position, velocity = signals["effort"], signals["position"], signals["velocity"]
        motor = _Motor(effort, values, _constants(signals, constants), time_step)
        if memory is None:
            before, velocity_before, passed_before = motor.at_rest(effort, position, velocity), velocity, None
        else:
            before, velocity_before, passed_before = memory
        after = before @ motor.moved.mT + motor.gained(effort, position, velocity)
        passed = motor.transmitted(effort, velocity, before, after)
        further = velocity - velocity_before
        within = torch.where(motor.rigid, 0.0, 0.5 * motor.braking * further)
        gained = motor.inertia / motor.load * (passed if passed_before is None else passed - passed_before)
        carried = gained + motor.inertia * further / time_step
        return {"effort": passed + carried + within}, (after, velocity, passed)

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Return blocks with the effort that the shaft transmits, and J_m · dv/dt, around each sample.

        A recorded sample stands for the interval around it. Blocks that follow each other are joined. The load moves
        by its recorded velocity: only its motion against the motor counts, and the spring would multiply the noise of
        a position by its stiffness.
        """
        chains = chains_of(signals, time_step, _TOGETHER)
        effort, velocity = (chains.joined(signals[name]) for name in ("effort", "velocity"))
        position = time_step * (torch.cumsum(velocity, dim=1) - velocity)
        motor = _Motor(effort, values, _constants(signals, constants), time_step)
        first = motor.at_rest(effort[:, :1], position[:, :1], velocity[:, :1])
        gained = torch.cat([first, motor.gained(effort, position, velocity)], dim=1)
        states = accumulated_states(motor.moved, gained)
        transmitted = motor.transmitted(effort, velocity, states[:, :-1], states[:, 1:])
        (acceleration,) = torch.gradient(velocity, spacing=time_step, dim=1)
        return {**signals, "effort": chains.parted(transmitted + motor.inertia * acceleration)}


class _Motor:
    """The motor on its spring over one step in which its effort is held and the load moves on at its velocity.

    The state (..., 2) is the motor's position and velocity.
    """

    def __init__(self, like: Tensor, values: Values, constants: Values, time_step: float) -> None:
        def number(value: Any) -> Tensor:
            return torch.as_tensor(value, dtype=like.dtype, device=like.device)

        share = number(values["motor_inertia_share"])
        inertia, pace = number(constants["inertia"]), 2.0 * torch.pi * number(values["frequency"])
        self.time_step, self.braking = time_step, number(constants["braking"])
        self.rigid = share == 0.0
        self.inertia, self.load = inertia * share, inertia * (1.0 - share)
        self.stiffness = self.load * pace.square()
        turning = inertia * share.clamp_min(_LEAST_SHARE)
        damping = 2.0 * number(values["damping_ratio"]) * self.load * pace + self.braking
        own = (self.stiffness / turning).sqrt()
        # Positions count times the natural frequency: both rows are then of one size.
        zero = torch.zeros_like(own)
        rate = torch.stack([torch.stack([zero, own]), torch.stack([-own, -damping / turning])])
        size = torch.stack([own, torch.ones_like(own)])
        self.moved = torch.linalg.matrix_exp(rate * time_step) * size / size[:, None]

    def at_rest(self, effort: Tensor, position: Tensor, velocity: Tensor) -> Tensor:
        """Return the state in which the shaft holds the effort and turns with the load, (..., 2)."""
        return torch.stack([position + effort / self.stiffness, velocity], dim=-1)

    def gained(self, effort: Tensor, position: Tensor, velocity: Tensor) -> Tensor:
        """Return the state after a step that starts from zero, (..., 2)."""
        settled = self.at_rest(effort, position, velocity)
        further = torch.stack([self.time_step * velocity, torch.zeros_like(velocity)], dim=-1)
        return settled + further - settled @ self.moved.mT

    def transmitted(self, effort: Tensor, velocity: Tensor, before: Tensor, after: Tensor) -> Tensor:
        """Return the mean effort on the load over a step: what the motor's inertia and back-EMF do not take up."""
        change = (after - before) / self.time_step
        kept = self.inertia * change[..., 1] + self.braking * (change[..., 0] - velocity)
        return effort - torch.where(self.rigid, 0.0, kept)


def _constants(signals: Signals, constants: Values) -> dict[str, Any]:
    """Return the inertia of both, and the back-EMF's damping of the motor at the joint, N·m·s/rad."""
    if "voltage" not in signals:
        return {"inertia": constants["inertia"], "braking": 0.0}
    constant = constants["torque_constant"] * constants["gear_ratio"]
    return {"inertia": constants["inertia"], "braking": constant * constant / constants["resistance"]}
