"""The voltage that a flight leaves behind: a lithium-polymer pack sized for the machine."""

import numpy as np
import torch

from pipeline.physics import batteries
from pipeline.platforms import Quadrotor
from pipeline.reality.rotation import Array

_CELL_NOMINAL = 3.7  # V
_EFFICIENCY = 0.6  # of motor and speed controller together
_HOVER_TIME = 360.0  # s that a full pack carries the machine
_SERIES_SAG, _RELAXED_SAG = 0.03, 0.02  # of the nominal voltage lost at hover, at once and after a while
_RELAXATION = 8.0  # s


def terminal_voltage(
    platform: Quadrotor, rotor_speed: Array, time_step: float, random: np.random.Generator
) -> Array:
    """Return the battery's voltage (samples, runs), V.

    Rotors draw Q·Ω = c·Ω³ of shaft power each. Speed controllers hold the rotor speed whatever the voltage.

    Args:
        platform: sizes the pack.
        rotor_speed: (samples, runs, 4) rad/s.
        time_step: s.
        random: each run starts with another charge.
    """
    cells = max(round(platform.nominal_voltage / _CELL_NOMINAL), 1)
    shaft = platform.torque_coefficient * torch.from_numpy(rotor_speed).pow(3).sum(dim=-1)
    power = shaft / _EFFICIENCY  # (samples, runs)
    hover = 4.0 * platform.torque_coefficient * platform.hover_rotor_speed**3 / _EFFICIENCY
    hover_current = hover / platform.nominal_voltage
    series = _SERIES_SAG * platform.nominal_voltage / hover_current
    relaxed = _RELAXED_SAG * platform.nominal_voltage / hover_current
    charge = torch.from_numpy(random.uniform(0.6, 1.0, power.shape[1]))
    relaxation = torch.zeros_like(charge)
    voltages = []
    for drawn in power:
        rested = batteries.open_circuit_voltage(charge, cells)
        current = batteries.current_for_power(drawn, rested - relaxation, series)
        voltages.append(batteries.terminal_voltage(rested, relaxation, current, series))
        relaxation = batteries.relaxation_step(relaxation, current, relaxed, _RELAXATION / relaxed, time_step)
        charge = batteries.charge_step(charge, current, _HOVER_TIME * hover_current, time_step)
    return torch.stack(voltages).numpy()
