"""Delays and lags that are shorter than the sampling can show: they stay in the simulator, but get no name.

Without them in the simulator, their effect would be attributed to other physics.
"""

from collections.abc import Sequence
from dataclasses import replace

from simgap.gap.name import Naming, name
from simgap.gap.prepare import Prepared
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect

_LAG_PASSES = 3  # most repetitions of the selection


def name_with_short_lags(prepared: Prepared, settings: Gap) -> tuple[Prepared, Naming]:
    """Select effects; short lags become part of the nominal simulator and the selection runs again."""
    naming = name(prepared.nominal, prepared.problem, settings)
    for _ in range(_LAG_PASSES):
        if not naming.short:
            break
        prepared = _with_lags(prepared, naming.short)
        naming = name(prepared.nominal, prepared.problem, settings)
    return prepared, naming


def _with_lags(prepared: Prepared, short: Sequence[FittedEffect]) -> Prepared:
    """Return the prepared data with some effects known, and a remark about each."""
    nominal, sample = prepared.nominal, prepared.problem.blocks.time_step
    keys = {fitted.effect.key for fitted in short}
    others = tuple(fitted for fitted in nominal.effects if fitted.effect.key not in keys)
    known = tuple(replace(fitted, known=True) for fitted in short)
    constants = nominal.constants()
    remarks = [
        f"{f.effect.name}: {f.effect.lateness(f.values, constants):.2g} s is too short to be told from the timing of "
        f"the commands, with samples {sample:.2g} s apart; it stays in the simulator, but is not named"
        for f in short
    ]
    settled = nominal.with_effects((*others, *known))
    return replace(prepared, nominal=settled, remarks=[*prepared.remarks, *remarks])
