"""Files of WPILib's SysId: one axis, in rotations or in the units that the file names."""

import numpy as np

from simgap.logs.log import Log
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposal, Proposed
from simgap.recordings.importers.sysid_units import UNITS, Reading, Samples, described, readings_of, scale_of

_FORMAT = "SysId JSON"
_ONE_READING, _SEVERAL = 0.95, 0.5


def propose(log: Log, kind: str | None) -> Proposal | None:
    """Propose a mapping of a SysId file; None for other formats. It is sure where the numbers have one reading.

    Args:
        log: as it was read.
        kind: of the platform.

    Raises:
        InputError: when no reading of the numbers makes sense.
    """
    if log.format != _FORMAT:
        return None
    if kind not in (None, "joint"):
        return Proposal(kind, {}, refusal="SysId files are of single axes: give a platform of kind joint")
    units, per_rotation = log.facts["units"], float(log.facts["unitsPerRotation"])
    found = readings_of(_runs(log), units, per_rotation, log.path)
    confidence = _ONE_READING if len(found) == 1 else _SEVERAL
    reason = described(found, units)
    columns = {
        name: Proposed(_source(name, found[-1], units, per_rotation), confidence, reason)
        for name in ("position", "velocity")
    }
    columns["voltage"] = Proposed(Source("voltage", "V", held=True), 1.0, "SysId writes volts")
    notes = () if len(found) == 1 else tuple(_choice(each, units, per_rotation) for each in found)
    return Proposal("joint", columns, notes=notes)


def _runs(log: Log) -> list[Samples]:
    signals = [log.signals[name] for name in ("voltage", "position", "velocity")]
    cuts = [slice(*np.searchsorted(signals[0].time, [span.begin, span.end])) for span in log.spans]
    return [Samples(signals[0].time[cut], *(signal.values[cut] for signal in signals)) for cut in cuts]


def _source(column: str, reading: Reading, units: str, per_rotation: float) -> Source:
    unit, factor = UNITS[units]
    sort = reading.position if column == "position" else reading.velocity
    unit = unit if column == "position" else f"{unit}/s"
    return Source(column, unit, scale=scale_of(sort, factor, per_rotation))


def _choice(reading: Reading, units: str, per_rotation: float) -> str:
    """Return what to write into the mapping for a reading."""
    scales = [_source(column, reading, units, per_rotation).scale for column in ("position", "velocity")]
    return (
        f"For {described([reading], units)}: scale {scales[0]:.6g} of position, {scales[1]:.6g} of velocity."
    )
