"""A recording: samples of a robot in SI units, in the names of the contract."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pandas as pd

from simgap.errors import InputError
from simgap.recordings import doubts, storage, validation


@dataclass(frozen=True)
class Recording:
    """Samples of one or more runs of one robot.

    World and body frame x forward, y left, z up; quaternions scalar-first, body to world.

    Attributes:
        frame: columns `run` (text), `t` (s), `segment` and `filled` (integers, once cleaned) and channels
            (float64).
        kind: quadrotor, swerve or joint.
        units: unit of each channel.
        source: where the recording comes from, to be cited.
        licence: under which licence it was published.
        split: run to train, validation or holdout; empty until cleaned.
        clock_offset: run to the time by which the state channels lag the motor telemetry, s (positive: the
            state is late), as cleaning estimated it; not applied to the data.
        noise_kept: run to the share of white noise that a fifth difference still shows after interpolation, where
            samples were moved.
        warnings: what looks wrong, one sentence each.
        cleaned: uniform in time inside each (run, segment) and no gap in a required channel.
    """

    frame: pd.DataFrame
    kind: str
    units: dict[str, str]
    source: str = ""
    licence: str = ""
    split: dict[str, str] = field(default_factory=dict)
    clock_offset: dict[str, float] = field(default_factory=dict)
    noise_kept: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    cleaned: bool = False

    @property
    def runs(self) -> list[str]:
        """The runs in the order of the recording."""
        return [str(run) for run in self.frame["run"].unique()]

    @property
    def channels(self) -> list[str]:
        """The measured channels, in the order of the frame."""
        return [str(column) for column in self.frame.columns if column in self.units]

    @property
    def time_step(self) -> float:
        """Time between two samples, s.

        Raises:
            InputError: when the recording is not cleaned, and so has no single time step.
        """
        if not self.cleaned:
            raise InputError(
                "is not uniformly sampled", self.source or "recording", "clean it first: simgap clean"
            )
        keys = ["run", "segment"] if "segment" in self.frame else ["run"]
        steps = self.frame.groupby(keys, sort=False)["t"].diff().to_numpy()
        return float(np.nanmedian(steps))


def read_recording(path: str | Path, kind: str | None = None) -> Recording:
    """Read a recording from Parquet, or from CSV with the same header.

    Units declared in the file are converted to the contract's; where none is declared, those are assumed.
    Rows are counted from 1, the first sample.

    Args:
        path: the file.
        kind: what to take it for where the file does not say; inferred from the columns where neither says.

    Raises:
        InputError: when the file cannot be used, naming file, run, row and column.
    """
    return recording_from_table(storage.read_table(Path(path)), kind, str(path))


def recording_from_table(
    table: storage.Table, kind: str | None = None, where: str = "recording"
) -> Recording:
    """Make a recording of a table as it was stored, or as a person has it in memory.

    Args:
        table: columns with the units that are declared, and metadata.
        kind: what to take it for where the metadata do not say; inferred from the columns where neither says.
        where: what to name in an error.

    Raises:
        InputError: when the table cannot be used, naming run, row and column.
    """
    metadata = table.metadata
    kind = validation.resolve_kind(metadata.get("platform_kind"), kind, table.frame, where)
    frame, units, remarks = validation.validate(table.frame, table.units, kind, where)
    cleaned = bool(metadata.get("simgap.cleaned"))
    noticed = () if cleaned else (*table.remarks, *remarks, *doubts.doubts(frame, units))
    known = tuple(metadata.get("simgap.warnings") or ())
    return Recording(
        frame=frame,
        kind=kind,
        units=units,
        source=metadata.get("source") or "",
        licence=metadata.get("licence") or "",
        split=dict(metadata.get("simgap.split") or {}),
        clock_offset=dict(metadata.get("simgap.clock_offset") or {}),
        noise_kept=dict(metadata.get("simgap.noise_kept") or {}),
        warnings=tuple(dict.fromkeys((*known, *noticed))),
        cleaned=cleaned,
    )


def recording_from_frame(
    frame: pd.DataFrame,
    kind: str,
    sliding: bool = False,
    warnings: Iterable[str] = (),
    where: str = "recording",
) -> Recording:
    """Make a recording of samples that are in the contract's units and frames already.

    Args:
        frame: `run`, `t` and channels.
        kind: quadrotor, swerve or joint.
        sliding: whether a joint's position is in metres.
        warnings: what is known to be doubtful.
        where: what to name in an error.

    Raises:
        InputError: when the samples break the contract.
    """
    declared = {"position": "m"} if sliding else {}
    checked, units, remarks = validation.validate(frame, declared, kind, where)
    noticed = doubts.doubts(checked, units)
    return Recording(checked, kind, units, warnings=(*warnings, *remarks, *noticed))


def write_recording(recording: Recording, path: str | Path) -> None:
    """Write a recording as Parquet; the same content gives the same bytes.

    Raises:
        InputError: when the file cannot be written.
    """
    metadata: Mapping[str, object] = {
        "platform_kind": recording.kind,
        "source": recording.source,
        "licence": recording.licence,
        "simgap.split": recording.split,
        "simgap.clock_offset": recording.clock_offset,
        "simgap.noise_kept": recording.noise_kept,
        "simgap.cleaned": recording.cleaned,
        "simgap.warnings": list(recording.warnings),
    }
    storage.write_table(recording.frame, recording.units, metadata, Path(path))


def require_kind(recording: Recording, kind: str, where: str = "recording") -> None:
    """Check that recording and platform are of one kind.

    Raises:
        InputError: when the kinds differ.
    """
    if recording.kind != kind:
        raise InputError(
            f"is of a {recording.kind}, the platform is a {kind}",
            where,
            "choose the platform that was recorded",
        )
