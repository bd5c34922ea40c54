"""The stage that finds the physics that a simulator lacks."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from simgap.errors import InputError
from simgap.gap.settings import Gap
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.dataset import Dataset
from simgap.recordings.recording import Recording
from simgap.runner import StageConfig, StageRun, stage
from simgap.simulation.settings import SimulatorSettings


@dataclass
class DiagnoseStage(StageConfig):
    """The configuration of the diagnosis."""

    recording: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)
    simulator: SimulatorSettings = field(default_factory=SimulatorSettings)
    gap: Gap = field(default_factory=Gap)


@stage(DiagnoseStage)
def diagnose(config: DiagnoseStage, run: StageRun) -> None:
    """Find where a simulator and a recording differ, name the missing physics, and validate it on held-out runs."""
    import torch

    from simgap.gap.contract import diagnosis_document, write_json
    from simgap.gap.diagnosis import diagnose as find_gap
    from simgap.gap.evidence import write_evidence
    from simgap.report.terminal import terminal_lines
    from simgap.simulation import read_simulator, write_simulator

    # The tensors of a diagnosis are small: a second thread waits more than it works.
    torch.set_num_threads(1)
    built = config.artifact("build_sim", "simulator.yaml")
    own = config.recording is not None
    if not own and not built.exists():
        raise InputError(
            "no recording is given", "recording", "give recording=PATH, or branch=NAME after simgap build_sim"
        )
    nominal = None if own else read_simulator(run.input(built).parent)
    recording, nominal = _recording_and_nominal(config, run, nominal)
    diagnosis = find_gap(recording, nominal, config.gap)
    document = diagnosis_document(diagnosis)
    write_simulator(diagnosis.simulator, run.output / "simulator")
    write_evidence(diagnosis, run.output / "evidence")
    write_json(document, run.output / "diagnosis.json")
    for warning in diagnosis.warnings:
        run.warn(warning)
    fit = {key: document["fit"][key] for key in ("before", "after", "noise_floor", "gap_closed")}
    run.log_metrics({key: value for key, value in fit.items() if value is not None})
    if own:
        _write_page(config, run)
    print(*terminal_lines(document), sep="\n")


def _recording_and_nominal(config: DiagnoseStage, run: StageRun, nominal: Any) -> tuple[Recording, Any]:
    """Return the recording, cleaned if it is not yet, and the simulator to diagnose."""
    from simgap.platforms import platform_from_config
    from simgap.recordings.cleaning import clean_with_coverage
    from simgap.recordings.recording import read_recording, require_kind, write_recording
    from simgap.simulation.build import build_simulator

    path = run.input(config.recording or config.artifact("clean", "recording.parquet"))
    kind = nominal.platform.kind if nominal else platform_from_config(config.platform).kind
    recording = read_recording(path, kind)
    require_kind(recording, kind, str(path))
    nominal = nominal or build_simulator(config.platform, config.simulator, recording.units)
    if not recording.cleaned:
        cleaned = clean_with_coverage(recording, config.clean, config.dataset.split, config.seed)
        folder = run.output / "clean"
        folder.mkdir()
        cleaned.changes.to_parquet(folder / "changes.parquet", index=False)
        cleaned.coverage.to_parquet(folder / "coverage.parquet", index=False)
        write_recording(cleaned.recording, folder / "recording.parquet")
        recording = cleaned.recording
    return recording, nominal


def _write_page(config: DiagnoseStage, run: StageRun) -> None:
    from simgap.report import ReportInputs, write_page

    clean = run.output / "clean"
    name = Path(config.recording or config.name).name
    simulator = f"{config.output or config.artifact('diagnose', '')}/simulator"
    inputs = ReportInputs(
        diagnose=run.output, clean=clean if clean.is_dir() else None, name=name, simulator=simulator
    )
    write_page(inputs, run.output / "report.html")


if __name__ == "__main__":
    from simgap.runner.command import main

    main(diagnose)
