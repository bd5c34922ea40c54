"""Thevenin model of a battery: a charge-dependent source, a resistance and an RC pair.

Chen & Rincón-Mora 2006, "Accurate electrical battery model capable of predicting runtime and I–V
performance", IEEE Transactions on Energy Conversion 21(2).
"""

import torch

from simgap.physics.motors import first_order_lag
from simgap.physics.shapes import Real, Value

# Open-circuit voltage of one lithium-polymer cell against its state of charge, equation (2) of the source, V.
_CELL_KNEE, _CELL_KNEE_RATE = -1.031, 35.0
_CELL_POLYNOMIAL = (3.685, 0.2156, -0.1178, 0.3201)


def open_circuit_voltage(state_of_charge: Real, cells: int = 1) -> Real:
    """Return the voltage of a rested lithium-polymer battery, V.

    Args:
        state_of_charge: 0 (empty) to 1 (full).
        cells: in series.
    """
    knee = _CELL_KNEE * torch.exp(-_CELL_KNEE_RATE * state_of_charge)
    return cells * (knee + sum(c * state_of_charge**power for power, c in enumerate(_CELL_POLYNOMIAL)))


def terminal_voltage(open_circuit: Real, relaxation: Real, current: Real, resistance: Value) -> Real:
    """Return the voltage at the terminals under load, V.

    Args:
        open_circuit: voltage of the rested battery, V.
        relaxation: voltage over the resistor–capacitor pair, V.
        current: drawn, A.
        resistance: in series, Ω.
    """
    return open_circuit - relaxation - resistance * current


def relaxation_step(
    relaxation: Real, current: Real, resistance: Value, capacitance: Value, dt: float
) -> Real:
    """Return the voltage over the resistor–capacitor pair dt later, exact for a held current, V.

    Args:
        relaxation: the voltage now, V.
        current: drawn, A.
        resistance: of the pair, Ω.
        capacitance: of the pair, F.
        dt: s.
    """
    return first_order_lag(relaxation, resistance * current, resistance * capacitance, dt)


def charge_step(state_of_charge: Real, current: Real, capacity: Value, dt: float) -> Real:
    """Return the state of charge dt later (coulomb counting).

    Args:
        state_of_charge: now, 0 to 1.
        current: drawn, A.
        capacity: C (1 mA·h is 3.6 C).
        dt: s.
    """
    return state_of_charge - current * dt / capacity


def current_for_power(power: Real, source_voltage: Real, resistance: Value) -> Real:
    """Return the current at which a source behind a resistance delivers a power, A.

    The lesser root of P = (E − R·I)·I. Beyond the greatest power E²/4R, the current of the greatest power.

    Args:
        power: at the terminals, W.
        source_voltage: E, V.
        resistance: R, Ω.
    """
    discriminant = (source_voltage.square() - 4.0 * resistance * power).clamp_min(0.0)
    return (
        2.0
        * power.minimum(source_voltage.square() / (4.0 * resistance))
        / (source_voltage + torch.sqrt(discriminant))
    )
