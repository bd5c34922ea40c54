"""The stage that says which physics a simulator lacks."""

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

_TIMES_NOISE = (
    2.0  # times the noise's standard deviation, left beside which nobody should believe that all is found
)


@dataclass
class DiagnoseStage(StageConfig):
    """What the diagnosis reads of the configuration."""

    recording: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)
    simulator: SimulatorSettings = field(default_factory=SimulatorSettings)
    gap: Gap = field(default_factory=Gap)


@stage(DiagnoseStage)
def diagnose(config: DiagnoseStage, run: StageRun) -> None:
    """Say where a simulator and a recording differ, which physics was left out, and prove it."""
    import torch

    from simgap.gap.contract import diagnosis_document, write_json
    from simgap.gap.diagnosis import diagnose as find_gap
    from simgap.gap.evidence import write_evidence
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
    numbers = {key: value for key, value in fit.items() if value is not None}
    run.log_metrics(numbers)
    run.log_results(numbers)
    run.describe({"verdict": document["verdict"], "effects": _believed(document)})
    if own:
        _write_page(config, run)
    _say(document)


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


def _believed(document: dict[str, Any]) -> str:
    """Return the effects that are believed, most probable first: `rotor_drag 0.98, motor_lag 0.71`."""
    believed = [effect for effect in document["effects"] if effect["probability"] >= 0.5]
    return ", ".join(f"{effect['name']} {effect['probability']:.2f}" for effect in believed) or "none"


def _write_page(config: DiagnoseStage, run: StageRun) -> None:
    from simgap.report import ReportInputs, write_page

    clean = run.output / "clean"
    name = Path(config.recording or config.name).name
    inputs = ReportInputs(diagnose=run.output, clean=clean if clean.is_dir() else None, name=name)
    write_page(inputs, run.output / "report.html")


def _say(document: dict[str, Any]) -> None:
    print(f"verdict: {document['verdict']}")
    for effect in document["effects"]:
        perhaps = "" if effect["probability"] >= 0.5 else "perhaps: "
        print(f"  {effect['name']} (probability {effect['probability']:.2f}): {perhaps}{effect['statement']}")
    for rivals in document["ambiguous"]:
        print(f"  not told apart here: {', '.join(rivals['names'])}. To tell them: {rivals['separate_by']}")
    for unnamed in document["unnamed"]:
        print(
            f"  no name for {unnamed['share']:.0%} of the error in {unnamed['channel']}: {unnamed['formula']}"
        )
    if document["effects"]:
        _say_what_closed(document["fit"])


def _say_what_closed(fit: dict[str, Any]) -> None:
    """Print the share of the gap that closed, never rounded up to all of it, and how much is left beside the noise."""
    from simgap.report.text import NARROW_SPACE, percent

    closed, left = fit["gap_closed"], fit["after"] / fit["noise_floor"] if fit["noise_floor"] else None
    if closed is None:
        return
    share = percent(closed).replace(NARROW_SPACE, "")
    rest = (
        f" (what is left is {left:.2g} times the noise)" if left is not None and left > _TIMES_NOISE else ""
    )
    print(f"gap closed on held-out runs: {share}{rest}")


if __name__ == "__main__":
    diagnose.main()
