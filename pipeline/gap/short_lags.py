"""Times that are shorter than samples can tell: they are taken into account, and not named.

What so short a time does is there all the same, and would pass for other physics if it were left over.
"""

from collections.abc import Sequence
from dataclasses import replace

from simgap.gap.name import Naming, name
from simgap.gap.prepare import Prepared
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect

_LAG_PASSES = 3  # in which one time after another may turn out to be short


def name_with_short_lags(prepared: Prepared, settings: Gap) -> tuple[Prepared, Naming]:
    """Name what is missing beside the short times, which become part of the nominal simulator."""
    naming = name(prepared.nominal, prepared.problem, settings)
    for _ in range(_LAG_PASSES):
        if not naming.short:
            break
        prepared = _with_lags(prepared, naming.short)
        naming = name(prepared.nominal, prepared.problem, settings)
    return prepared, naming


def _with_lags(prepared: Prepared, short: Sequence[FittedEffect]) -> Prepared:
    """Return what a diagnosis works on with some effects known, and a remark about each."""
    nominal, sample = prepared.nominal, prepared.problem.blocks.time_step
    keys = {fitted.effect.key for fitted in short}
    others = tuple(fitted for fitted in nominal.effects if fitted.effect.key not in keys)
    known = tuple(replace(fitted, known=True) for fitted in short)
    constants = nominal.constants()
    remarks = [
        f"{f.effect.name}: {f.effect.lateness(f.values, constants):.2g} s is less than samples {sample:.2g} s apart "
        "can tell from how a command is held; it is in the simulator, and not named"
        for f in short
    ]
    settled = nominal.with_effects((*others, *known))
    return replace(prepared, nominal=settled, remarks=[*prepared.remarks, *remarks])
