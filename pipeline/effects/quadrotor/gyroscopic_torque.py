"""Rotors that do not like to be turned."""

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import along_axes, spin_momentum
from simgap.physics.rigid_body import gyroscopic_torque
from simgap.physics.shapes import Channels


class GyroscopicTorque(WrenchEffect):
    """Roll and pitch torque of the net spin of the rotors when the body turns."""

    name = "gyroscopic_torque"
    kind = "quadrotor"
    acts_on = "torque"
    parameters = (Parameter("inertia", "kg·m²", 1e-5, 0.0, 1e-2),)
    needs = ("body_rate", "rotor_speed")
    formula = "τ = −ω × (inertia · Σ spin · Ω · e_z), spin = −direction of the reaction torque"
    source = "Bouabdallah 2007, Design and control of quadrotors with application to autonomous flying, §2.4"
    sentence = (
        "The spinning rotors turn roll into pitch and back while they yaw the machine: each has a moment of inertia "
        "of {inertia} kg·m²; add the gyroscopic torque to the simulator."
    )
    excitation = "roll and pitch quickly while yawing hard, so that one pair of rotors outruns the other"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the torque, N·m."""
        spin = values["inertia"] * spin_momentum(signals["rotor_speed"], constants)
        still = torch.zeros_like(spin)
        momentum = torch.stack([still, still, spin], dim=-1)
        return along_axes("torque", gyroscopic_torque(signals["body_rate"], momentum))
