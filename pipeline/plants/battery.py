"""A lithium-polymer pack sized for the machine: a source that falls with charge, a resistance, an RC pair.

Chen & Rincón-Mora 2006, "Accurate electrical battery model capable of predicting runtime and I–V performance",
equation (2) and figure 2. Written apart from `simgap.physics`, lest errors be shared.
"""

import numpy as np

from simgap.plants.rotation import Array
from simgap.platforms import Quadrotor

_KNEE, _KNEE_RATE = -1.031, 35.0  # V of one cell
_POLYNOMIAL = (3.685, 0.2156, -0.1178, 0.3201)  # V of one cell
_CELL_NOMINAL = 3.7  # V
_EFFICIENCY = 0.6  # of motor and speed controller together
_HOVER_TIME = 360.0  # s that a full pack carries the machine
_SERIES_SAG, _RELAXED_SAG = 0.03, 0.02  # of the nominal voltage lost at hover, at once and after a while
_RELAXATION = 8.0  # s


class Battery:
    """The packs of all runs; call it with what the rotors' shafts draw to let time pass."""

    def __init__(self, platform: Quadrotor, charge: Array, wear: float = 1.0) -> None:
        """Size the pack by the hover power.

        Args:
            platform: the machine as its builder knows it.
            charge: state of charge at the start, (runs,).
            wear: factor on both resistances.
        """
        self.cells = max(round(platform.nominal_voltage / _CELL_NOMINAL), 1)
        self.torque_coefficient = platform.torque_coefficient
        hover = 4.0 * platform.torque_coefficient * platform.hover_rotor_speed**3 / _EFFICIENCY
        current = hover / platform.nominal_voltage
        self.capacity = _HOVER_TIME * current  # C
        self.series = wear * _SERIES_SAG * platform.nominal_voltage / current
        self.relaxed = wear * _RELAXED_SAG * platform.nominal_voltage / current
        self.charge = np.array(charge, dtype=np.float64)
        self.relaxation = np.zeros_like(self.charge)

    def rested(self) -> Array:
        """Return the voltage without load (runs,), V."""
        charge = self.charge
        polynomial = sum(factor * charge**power for power, factor in enumerate(_POLYNOMIAL))
        return self.cells * (_KNEE * np.exp(-_KNEE_RATE * charge) + polynomial)

    def __call__(self, rotor_speed: Array, step: float) -> Array:
        """Return the terminal voltage (runs,), V, under rotors (runs, 4), rad/s, and discharge for a step, s.

        Rotors draw Q·Ω = c·Ω³ of shaft power each.
        """
        power = self.torque_coefficient * (rotor_speed**3).sum(axis=-1) / _EFFICIENCY
        rested = self.rested()
        source = rested - self.relaxation
        greatest = source * source / (4.0 * self.series)
        drawn = np.minimum(power, greatest)
        current = (
            2.0 * drawn / (source + np.sqrt(np.maximum(source * source - 4.0 * self.series * power, 0.0)))
        )
        voltage = source - self.series * current
        towards = self.relaxed * current
        self.relaxation = towards + (self.relaxation - towards) * np.exp(-step / _RELAXATION)
        self.charge = self.charge - current * step / self.capacity
        return voltage


def voltage_behind(battery: Battery, rotor_speed: Array, step: float) -> Array:
    """Return the voltage (samples, runs), V, that rotor speeds (samples, runs, 4) leave behind."""
    return np.stack([battery(speed, step) for speed in rotor_speed])
