"""The stage that finds the physics that a simulator lacks."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.errors import InputError
from simgap.gap.settings import Gap
from simgap.platforms.settings import SimulatorSettings
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.dataset import Dataset
from simgap.runner import StageConfig, StageRun, stage

if TYPE_CHECKING:
    from simgap.recordings.recording import Recording
    from simgap.simulation import Simulator


@dataclass
class DiagnoseStage(StageConfig):
    """The configuration of the diagnosis."""

    recording: str | None = None
    mapping: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)
    simulator: SimulatorSettings = field(default_factory=SimulatorSettings)
    gap: Gap = field(default_factory=Gap)


@stage(DiagnoseStage)
def diagnose(config: DiagnoseStage, run: StageRun) -> None:
    """Find where a simulator and a recording differ, name the missing physics, and validate it on held-out runs.

    A recording of your own:

      simgap diagnose platform=arm.yaml recording=log.csv output=answer
      simgap diagnose platform=robot.urdf joint=elbow recording=log.mcap mapping=log.mcap.mapping.yaml output=answer

    platform   a YAML, URDF or MJCF file of what you know of the machine, or the name of one of the project
    joint      which joint of a URDF or MJCF file
    recording  a log of any format; simgap inspect shows what is in it
    mapping    which signal of the log is which column; simgap inspect proposes it
    output     the folder for the answer

    A branch of the pipeline, after simgap build_sim:

      simgap diagnose branch=nanodrone
    """
    from simgap.api.flow import diagnosed, write_report

    built = config.artifact("build_sim", "simulator.yaml")
    own = config.recording is not None
    if not own and not built.exists():
        raise InputError(
            "no recording is given", "recording", "give recording=PATH, or branch=NAME after simgap build_sim"
        )
    # First of all: a recording that cannot be used is refused before anything heavy is imported.
    recording, nominal = _own(config, run) if own else _of_branch(config, run)
    found = diagnosed(recording, nominal, config.gap, config.clean, config.dataset.split, config.seed)
    found.write(run.output)

    from simgap.report.terminal import terminal_lines, warning_lines

    for warning in warning_lines(found.document):
        run.warn(warning)
    fit = {key: found.document["fit"][key] for key in ("before", "after", "noise_floor", "gap_closed")}
    numbers = {key: value for key, value in fit.items() if value is not None}
    run.log_metrics(numbers)
    run.log_results(numbers)
    run.describe({"verdict": found.document["verdict"], "effects": _believed(found.document)})
    if own:
        simulator = f"{config.output or config.artifact('diagnose', '')}/simulator"
        name = Path(config.recording or config.name).name
        write_report(run.output, run.output / "report.html", name, simulator)

    from simgap.api.gains import gains_line

    print(*terminal_lines(found.document), *([gains_line(found.gains)] if found.gains else []), sep="\n")


def _own(config: DiagnoseStage, run: StageRun) -> "tuple[Recording, Simulator]":
    """Return a person's own recording and what is believed of its platform."""
    from simgap.api.flow import nominal_simulator, with_assumptions
    from simgap.platforms import plain_config

    path = run.input(config.recording or "")
    platform = plain_config(config.platform)

    from simgap.logs.opening import open_recording  # with pandas: after the platform has been checked

    mapping = run.input(config.mapping) if config.mapping else None
    recording = open_recording(path, platform["kind"], mapping, platform)
    recording = with_assumptions(recording, config.platform)
    return recording, nominal_simulator(recording, config.platform, config.simulator, str(path))


def _of_branch(config: DiagnoseStage, run: StageRun) -> "tuple[Recording, Simulator]":
    """Return the cleaned recording and the simulator of the stages before."""
    from simgap.recordings.recording import read_recording, require_kind
    from simgap.simulation import read_simulator

    nominal = read_simulator(run.input(config.artifact("build_sim", "simulator.yaml")).parent)
    path = run.input(config.artifact("clean", "recording.parquet"))
    recording = read_recording(path, nominal.platform.kind)
    require_kind(recording, nominal.platform.kind, str(path))
    return recording, nominal


def _believed(document: dict[str, Any]) -> str:
    """Return the effects that are believed, most probable first: `rotor_drag 0.98, motor_lag 0.71`."""
    believed = [effect for effect in document["effects"] if effect["probability"] >= 0.5]
    return ", ".join(f"{effect['name']} {effect['probability']:.2f}" for effect in believed) or "none"


if __name__ == "__main__":
    from simgap.runner.command import main

    main(diagnose)
