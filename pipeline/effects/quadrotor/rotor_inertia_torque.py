"""Reaction torque of accelerating rotors."""

from typing import Any

import torch

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import spin_momentum
from simgap.physics.shapes import Channels, Signal


class RotorInertiaTorque(ActuatorEffect, WrenchEffect):
    """A yaw torque opposes the acceleration of the rotors."""

    remembers = True
    order = 3
    name = "rotor_inertia_torque"
    kind = "quadrotor"
    acts_on = "torque"
    parameters = (Parameter("inertia", "kg·m²", 1e-5, 0.0, 1e-2),)
    needs = ("rotor_speed",)
    formula = "τ_z = −inertia · Σ spin · dΩ/dt, spin = −direction of the reaction torque"
    source = "Kaufmann et al. 2023, Champion-level drone racing using deep reinforcement learning, Methods"
    sentence = (
        "Each rotor's moment of inertia of {inertia} kg·m² twists the body when the rotor accelerates; add "
        "this torque to the simulator."
    )
    excitation = "yaw in steps to both sides"
    symptom = "The yaw torque has spikes when the rotor speeds change quickly."
    look_alikes = ("torque_coefficient_error",)

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the rotors' acceleration since the sample before, none at the first; the memory holds the speed."""
        speed = signals["rotor_speed"]
        before = speed if memory is None else memory
        return {"rotor_acceleration": (speed - before) / time_step}, speed

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Return recorded blocks with the rotors' acceleration by central differences."""
        (acceleration,) = torch.gradient(signals["rotor_speed"], spacing=time_step, dim=1)
        return {**signals, "rotor_acceleration": acceleration}

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the yaw torque, N·m."""
        return {"torque_z": -values["inertia"] * spin_momentum(signals["rotor_acceleration"], constants)}
