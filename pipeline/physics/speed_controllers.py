"""Electronic speed controllers without a speed loop.

Kaufmann et al. 2023, "Champion-level drone racing using deep reinforcement learning", Nature 620, Methods: the steady
rotor speed is a linear combination of 1, U, √u, u and U·√u, with U the battery's voltage and u the throttle.
"""

from typing import NamedTuple

import torch
from torch import Tensor

from simgap.physics.rotors import PerRotor
from simgap.physics.shapes import Real, Value


class SpeedMap(NamedTuple):
    """Coefficients of the steady rotor speed.

    Attributes:
        constant: rad/s.
        per_voltage: rad/s/V.
        per_root: over the root of the throttle, rad/s.
        per_throttle: rad/s.
        per_voltage_root: over voltage times the root of the throttle, rad/s/V.
    """

    constant: Value
    per_voltage: Value
    per_root: Value
    per_throttle: Value
    per_voltage_root: Value


def steady_speed(throttle: PerRotor, voltage: Real, speed_map: SpeedMap) -> PerRotor:
    """Return the steady rotor speed at a constant throttle, rad/s, at least zero.

    Args:
        throttle: (..., rotors), above 0 to 1.
        voltage: of the battery, (...,) V.
        speed_map: coefficients.
    """
    voltage, root = voltage[..., None], torch.sqrt(throttle)
    level = speed_map.constant + speed_map.per_voltage * voltage
    slope = speed_map.per_root + speed_map.per_voltage_root * voltage
    return (level + slope * root + speed_map.per_throttle * throttle).clamp_min(0.0)


def motor_speed(throttle: Real, voltage_ratio: Real, efficiency: float) -> Real:
    """Return the steady speed of a direct-current motor with a propeller, over that at full throttle.

    Voltage is resistance · current + K · Ω, and K · current = drag · Ω². With x = Ω/Ω_max and the share η of the full
    voltage that the speed takes, (1 − η)·x² + η·x is the applied voltage over the nominal one. The firmware's thrust
    linearisation is that which makes the speed proportional to the throttle at nominal voltage.

    Args:
        throttle: 0 to 1.
        voltage_ratio: of the battery over nominal.
        efficiency: η, of the motor at full throttle.
    """
    loss = 1.0 - efficiency
    applied = (loss * throttle.square() + efficiency * throttle) * voltage_ratio
    return 2.0 * applied / (efficiency + torch.sqrt(efficiency**2 + 4.0 * loss * applied))


def calibrated_speed_map(
    speed_max: float, hover_speed: float, nominal_voltage: float, efficiency: float
) -> SpeedMap:
    """Return the coefficients that describe a direct-current motor best, exact in hover and at full throttle.

    Least squares of the five terms to `motor_speed` over throttles 0.05 to 1 and voltages 0.89 to 1.11 of nominal
    (3.3 to 4.1 V of a cell of 3.7 V), under two conditions at nominal voltage: the throttle hover_speed/speed_max gives
    the hover speed, and full throttle the greatest.

    Args:
        speed_max: rotor speed at full throttle and nominal voltage, rad/s.
        hover_speed: rad/s.
        nominal_voltage: V.
        efficiency: of the motors at full throttle.
    """
    throttle, ratio = torch.meshgrid(
        torch.linspace(0.05, 1.0, 39, dtype=torch.float64),
        torch.linspace(0.89, 1.11, 12, dtype=torch.float64),
        indexing="ij",
    )
    wanted = motor_speed(throttle, ratio, efficiency).flatten()
    terms = _terms(throttle.flatten(), ratio.flatten())
    exact = torch.tensor([hover_speed / speed_max, 1.0], dtype=torch.float64)
    conditions = _terms(exact, torch.ones_like(exact))
    # Lagrange's conditions of the constrained least squares.
    zero = torch.zeros(2, 2, dtype=torch.float64)
    system = torch.cat(
        [torch.cat([terms.T @ terms, conditions.T], dim=1), torch.cat([conditions, zero], dim=1)]
    )
    solution = torch.linalg.solve(system, torch.cat([terms.T @ wanted, exact]))[:5]
    scale = torch.tensor([1.0, nominal_voltage, 1.0, 1.0, nominal_voltage], dtype=torch.float64)
    return SpeedMap(*(speed_max * solution / scale).tolist())


def _terms(throttle: Tensor, ratio: Tensor) -> Tensor:
    root = torch.sqrt(throttle)
    return torch.stack([torch.ones_like(root), ratio, root, throttle, ratio * root], dim=-1)
