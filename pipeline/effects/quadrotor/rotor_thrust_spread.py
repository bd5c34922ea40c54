"""Rotors of a healthy machine that are not alike.

Four ratios with a mean of one have three free numbers, so the fourth rotor makes up the balance. On a machine whose
rotors form a rectangle they are three patterns. What one side has more than the other, in pitch or in roll, acts as a
centre of mass off the middle does, at any thrust. What one diagonal has more acts on yaw as a trim does. Only the terms
between axes tell them apart: with uneven sides, roll or pitch commands change the lift and the yaw torque; with uneven
diagonals, roll commands also pitch the machine.
"""

import torch
from torch import Tensor

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_reaction, rotor_thrust
from simgap.physics.rotors import wrench
from simgap.physics.shapes import Channels

_FIRST_THREE = range(1, 4)
_MOST = 0.3  # beyond it a rotor is broken: propellers and motors of one batch differ by a few hundredths


class RotorThrustSpread(WrenchEffect):
    """Rotors give unequal thrust at the same speed, around an unchanged mean, and reaction torque in proportion."""

    name = "rotor_thrust_spread"
    kind = "quadrotor"
    acts_on = "actuator"
    # Of one size for all rotors, so that a prior favours none.
    parameters = tuple(
        Parameter(f"excess_{rotor}", "1", default, -_MOST, _MOST)
        for rotor, default in zip(_FIRST_THREE, (0.02, -0.02, 0.02), strict=True)
    )
    needs = ("rotor_speed",)
    formula = (
        "T_i = (1 + excess_i) · k · Ω_i², and its reaction torque likewise; "
        "excess_4 = −(excess_1 + excess_2 + excess_3)"
    )
    source = "Mahony, Kumar & Corke 2012, Multirotor aerial vehicles, eqs. 3 and 4, with coefficients of each rotor"
    sentence = (
        "Rotors 1, 2 and 3 give fractions {excess_1}, {excess_2} and {excess_3} more thrust than the mean of the "
        "four, and rotor 4 the balance; healthy rotors differ so. Give the simulator a coefficient per rotor."
    )
    excitation = (
        "roll, pitch and yaw hard one after another, and accelerate in all directions: in hover it is a centre of "
        "mass off the middle with a yaw trim"
    )
    symptom = "A roll command also pitches or lifts the machine a little, and hover needs four different rotor speeds."
    look_alikes = ("center_of_mass_offset", "yaw_trim", "rotor_fault")

    def stands_for(self, values: Values, constants: Values) -> float:
        """Return the share by which the coefficient of one rotor is off."""
        excess = [float(values[f"excess_{rotor}"]) for rotor in _FIRST_THREE]
        return max(map(abs, (*excess, sum(excess))))

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the change from an even machine: specific force, m/s², and torque, N·m."""
        thrust = rotor_thrust(signals, constants)
        excess = _excess(values, thrust)
        positions = constants["rotor_positions"].to(thrust)
        force, torque = wrench(excess * thrust, excess * rotor_reaction(signals, constants), positions)
        return {
            "force_z": force[..., 2] / constants["mass"],
            "torque_x": torque[..., 0],
            "torque_y": torque[..., 1],
            "torque_z": torque[..., 2],
        }


def _excess(values: Values, like: Tensor) -> Tensor:
    """Return what each rotor gives beyond the mean of the four, over that mean, (..., 4)."""
    first = [
        torch.as_tensor(values[f"excess_{n}"], dtype=like.dtype, device=like.device) for n in _FIRST_THREE
    ]
    return torch.stack([*first, -(first[0] + first[1] + first[2])], dim=-1)
