"""The one way from a recording to an answer, for the command line and for a person's own program."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.errors import InputError
from simgap.gap.settings import Gap
from simgap.platforms.settings import SimulatorSettings
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.split import Split

if TYPE_CHECKING:
    from simgap.diagnosis.diagnose import Diagnosis
    from simgap.models.identify import Identified
    from simgap.recordings.cleaning import Cleaned
    from simgap.recordings.recording import Recording
    from simgap.simulation import Simulator


@dataclass(frozen=True)
class Found:
    """A diagnosis with what it was made of.

    Attributes:
        diagnosis: of the gap engine.
        cleaned: the account of the cleaning; None where the recording was clean already.
        gains: feedforward gains of the motor of a joint; None for other machines.
    """

    diagnosis: "Diagnosis"
    cleaned: "Cleaned | None"
    gains: "Identified | None" = None

    @cached_property
    def document(self) -> dict[str, Any]:
        """The diagnosis as plain numbers, texts and lists: what `diagnosis.json` holds."""
        from simgap.diagnosis.contract import diagnosis_document

        return diagnosis_document(self.diagnosis)

    def write(self, folder: Path) -> None:
        """Write `diagnosis.json`, `simulator/`, `evidence/`, and `clean/` and `sysid/` where there are such."""
        from simgap.api.gains import write_gains
        from simgap.diagnosis.contract import write_json
        from simgap.diagnosis.evidence import write_evidence
        from simgap.simulation import write_simulator

        if self.cleaned is not None:
            _write_cleaned(self.cleaned, folder / "clean")
        if self.gains is not None:
            write_gains(self.gains, folder / "sysid")
        write_simulator(self.diagnosis.simulator, folder / "simulator")
        write_evidence(self.diagnosis, folder / "evidence")
        write_json(self.document, folder / "diagnosis.json")


def nominal_simulator(
    recording: "Recording", platform: Mapping[str, Any], settings: SimulatorSettings, where: str = "recording"
) -> "Simulator":
    """Return the simulator that is believed before the diagnosis of a recording.

    Args:
        recording: of the machine.
        platform: the keys of docs/contract.md.
        settings: effects that are known already.
        where: what to name in an error of the recording.

    Raises:
        InputError: on a wrong platform or effect, or when the recording is of another kind.
    """
    from simgap.platforms import platform_from_config
    from simgap.recordings.recording import require_kind

    require_kind(recording, platform_from_config(platform).kind, where)
    from simgap.simulation.build import build_simulator  # with torch: after what is refused has been refused

    return build_simulator(platform, settings, recording.units)


def with_assumptions(recording: "Recording", platform: Mapping[str, Any]) -> "Recording":
    """Return a recording whose warnings also say what the platform leaves open.

    Args:
        recording: of the machine.
        platform: the keys of docs/contract.md.
    """
    from simgap.platforms import platform_assumptions

    said = platform_assumptions(platform)
    return replace(recording, warnings=(*recording.warnings, *said)) if said else recording


def diagnosed(
    recording: "Recording", nominal: "Simulator", gap: Gap, clean: Cleaning, split: Split, seed: int = 0
) -> Found:
    """Clean a recording, where that was not done before, and say which physics a simulator lacks.

    Args:
        recording: of the machine.
        nominal: what is believed of it.
        gap: settings of the diagnosis.
        clean: settings of the cleaning.
        split: how the runs are divided.
        seed: of the draw that divides them by chance.

    Raises:
        InputError: when nothing usable is left after cleaning, or a setting is out of its range.
    """
    from simgap.api.gains import motor_gains
    from simgap.consistency import check
    from simgap.diagnosis.diagnose import diagnose
    from simgap.recordings.cleaning import clean_with_coverage

    gap.check()
    # Before cleaning: a column in a wrong unit looks like spikes, and would be cleaned away.
    checked = check(recording, nominal.platform)
    if not checked.contradictions:
        recording = _doubted(recording, nominal)
    try:
        cleaned = None if recording.cleaned else clean_with_coverage(recording, clean, split, seed)
        used = cleaned.recording if cleaned else recording
        with _one_thread():
            found = diagnose(used, nominal, gap, checked)
            gains = None if found.contradictions else motor_gains(used, nominal.platform, seed)
    except InputError as error:
        if not checked.contradictions:
            raise
        first = checked.contradictions[0]
        raise InputError(first.evidence, f"column {first.column!r}", first.remedy) from error
    return Found(found, cleaned, gains)


def _doubted(recording: "Recording", nominal: "Simulator") -> "Recording":
    """Return a recording whose warnings also say which size, gear ratio or motor looks wrong."""
    from simgap.consistency import gear_doubts, size_doubts
    from simgap.effects import ParameterError
    from simgap.platforms import Joint

    said = list(size_doubts(recording))
    corrected = any(isinstance(known.effect, ParameterError) for known in nominal.effects)
    if isinstance(nominal.platform, Joint) and not corrected:
        said += gear_doubts(recording, nominal.platform)
    return replace(recording, warnings=(*recording.warnings, *said)) if said else recording


def write_report(folder: Path, target: Path, name: str, simulator: str) -> None:
    """Write the page of a diagnosis that lies in a folder.

    Args:
        folder: that `Found.write` wrote.
        target: the HTML file.
        name: of the recording, for the heading.
        simulator: where the reader finds the simulator.
    """
    from simgap.report import ReportInputs, write_page

    clean, sysid = (part if part.is_dir() else None for part in (folder / "clean", folder / "sysid"))
    inputs = ReportInputs(diagnose=folder, clean=clean, sysid=sysid, name=name, simulator=simulator)
    write_page(inputs, target)


def _write_cleaned(cleaned: "Cleaned", folder: Path) -> None:
    from simgap.recordings.recording import write_recording

    folder.mkdir()
    cleaned.changes.to_parquet(folder / "changes.parquet", index=False)
    cleaned.coverage.to_parquet(folder / "coverage.parquet", index=False)
    write_recording(cleaned.recording, folder / "recording.parquet")


@contextmanager
def _one_thread() -> Iterator[None]:
    """Let torch have one thread: the tensors of a diagnosis are small, and a second one waits more than it works."""
    import torch

    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)
