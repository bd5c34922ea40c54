"""Gyroscopic torque of the spinning rotors."""

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import along_axes, spin_momentum
from simgap.physics.rigid_body import gyroscopic_torque
from simgap.physics.shapes import Channels


class GyroscopicTorque(WrenchEffect):
    """Rotors with a net spin cause a roll and pitch torque when the body turns."""

    name = "gyroscopic_torque"
    kind = "quadrotor"
    acts_on = "torque"
    parameters = (Parameter("inertia", "kg·m²", 1e-5, 0.0, 1e-2),)
    needs = ("body_rate", "rotor_speed")
    formula = "τ = −ω × (inertia · Σ spin · Ω · e_z), spin = −direction of the reaction torque"
    source = "Bouabdallah 2007, Design and control of quadrotors with application to autonomous flying, §2.4"
    sentence = (
        "Each rotor's moment of inertia of {inertia} kg·m² couples roll and pitch; add the gyroscopic torque "
        "to the simulator."
    )
    excitation = (
        "roll and pitch quickly while yawing hard, so that one pair of rotors is faster than the other"
    )
    symptom = "Fast roll comes with a pitch torque, and fast pitch with a roll torque, during hard yaw."

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the torque, N·m."""
        spin = values["inertia"] * spin_momentum(signals["rotor_speed"], constants)
        still = torch.zeros_like(spin)
        momentum = torch.stack([still, still, spin], dim=-1)
        return along_axes("torque", gyroscopic_torque(signals["body_rate"], momentum))
