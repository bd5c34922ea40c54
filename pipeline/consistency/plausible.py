"""Values against what they can be: a battery, a clock, a command, a voltage under its supply."""

from collections.abc import Iterator

import numpy as np

from simgap.consistency.law import Ratio
from simgap.consistency.redundancy import Agreement
from simgap.consistency.samples import Samples
from simgap.consistency.transformation import Transformation, scaled
from simgap.consistency.units import VOLTAGE, in_units

_IMPOSSIBLE = -9.0  # log likelihood of what cannot be: a number in ten thousand is logged that way
_CLEAR = -3.0
_PACK = Ratio(0.2)
"""A lithium cell has 3 to 4.35 V about its nominal 3.7 V."""

_CELL = 3.7  # V, nominal, of a lithium cell
_PACKS = (2.5, 60.0)  # V of a battery: an empty cell, and fourteen full ones
_STEP, _DECADES = 0.01, 2.5  # s; natural logarithm: logs have 1 Hz to 10 kHz
_USUAL_SUPPLY, _SUPPLIES = 12.0, 0.9  # V; natural logarithm: one cell to some sixty volts
_USED = 1.0  # natural logarithm of the share of the supply that is used
_OVER_SUPPLY = 1.3  # a supply that sags, and is logged on its own
_FULL = 0.2  # by which a command may overshoot


def plausibility(samples: Samples, nominal: float | None) -> Iterator[Agreement]:
    """Yield how plausible the values of single columns are.

    Args:
        samples: of the recording.
        nominal: voltage of the platform's supply, V, where it is known.
    """
    yield _clock(samples)
    yield from _battery(samples, nominal)
    yield from _voltages(samples, nominal)
    if samples.has("motor_command", "1234"):
        yield _command(samples)


def _clock(samples: Samples) -> Agreement:
    step = samples.time_step
    support = -0.5 * float(np.log(step / _STEP) / _DECADES) ** 2 if step > 0 else 0.0
    figures = f"one sample every {step:.3g} s"
    return Agreement("'t'", ("t",), max(support, _IMPOSSIBLE), support < _CLEAR, figures, step / _STEP)


def _battery(samples: Samples, nominal: float | None) -> Iterator[Agreement]:
    volts = supply_of(samples)
    if np.isnan(volts):
        return
    if nominal:
        support, told = _PACK.support(volts / nominal, 0.05), f" for a nominal {nominal:.3g} V"
    else:
        support, told = (0.0 if _PACKS[0] <= volts <= _PACKS[1] else _IMPOSSIBLE), ""
    name, figures = "'battery_voltage'", f"its median is {volts:.4g} V{told}"
    yield Agreement(name, ("battery_voltage",), support, support < _CLEAR, figures, volts / (nominal or 12.0))


def supply_of(samples: Samples) -> float:
    """Return the usual voltage of the battery, V, NaN where none was recorded; zero is no voltage of a battery."""
    if "battery_voltage" not in samples:
        return np.nan
    known = samples["battery_voltage"]
    known = known[np.isfinite(known) & (known != 0.0)]
    return float(np.median(known)) if len(known) else np.nan


def _voltages(samples: Samples, nominal: float | None) -> Iterator[Agreement]:
    """Yield the largest voltage of the motors against that of the supply, or against what supplies there are."""
    groups = {
        "joint": [["voltage"]],
        "swerve": [[f"{g}_voltage_{m}" for m in "1234"] for g in ("drive", "steer")],
    }
    known = supply_of(samples)
    supply = known if known == known else (nominal or np.nan)
    for columns in groups.get(samples.kind, []):
        if columns[0] not in samples:
            continue
        largest = max(float(np.nanquantile(np.abs(samples[column]), 0.99)) for column in columns)
        name, touched = f"{columns[0]!r}", (*columns, "battery_voltage")
        if supply == supply:
            over = largest > _OVER_SUPPLY * supply
            figures = f"{largest:.4g} V under a supply of {supply:.4g} V"
            # A supply is chosen for what the motors need: they hardly ever use a hundredth of it.
            used = -0.5 * min(float(np.log(max(largest, 1e-300) / supply) / _USED), 0.0) ** 2
            support = _IMPOSSIBLE if over else max(used, _IMPOSSIBLE)
            yield Agreement(name, touched, support, over, figures, largest / supply)
        elif largest > 0.0:
            support = max(-0.5 * float(np.log(largest / _USUAL_SUPPLY) / _SUPPLIES) ** 2, _IMPOSSIBLE)
            figures = f"up to {largest:.4g} V"
            yield Agreement(name, touched, support, support == _IMPOSSIBLE, figures, largest / _USUAL_SUPPLY)


def _command(samples: Samples) -> Agreement:
    values = samples.stack("motor_command", "1234")
    low, high = np.nanquantile(values, [0.01, 0.99])
    wrong = bool(high > 1.0 + _FULL or low < -_FULL)
    columns = ("motor_command_1..4",)
    figures = f"from {low:.4g} to {high:.4g}, and not from 0 to 1"
    return Agreement(
        "'motor_command_1..4'", columns, _IMPOSSIBLE if wrong else 0.0, wrong, figures, float(high)
    )


def supply_faults(samples: Samples, nominal: float | None) -> list[Transformation]:
    """Return the transformations of a battery's voltage."""
    columns = ("battery_voltage",)
    if columns[0] not in samples:
        return []
    found = in_units(columns[0], columns, VOLTAGE)
    cells = max(1, round((nominal or 0.0) / _CELL))
    if cells > 1:
        words = f"of one cell of {cells}"
        found.append(scaled("per_cell", columns[0], columns, 1.0 / cells, 0.04, f"scale: {cells}", words))
    return found
