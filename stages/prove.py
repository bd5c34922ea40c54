"""The concealed benchmark: cases are drawn, recorded, sealed, diagnosed, and only then held against their keys."""

import json
import shutil
import time
import traceback
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pipeline.gap.settings import Gap
from pipeline.proof.settings import Proof
from pipeline.recordings.cleaning.settings import Cleaning
from pipeline.recordings.dataset import Dataset
from pipeline.simulation.settings import SimulatorSettings
from pipeline.stage import Stage, StageConfig, StageRun, stage


@dataclass
class ProveStage(StageConfig):
    """What the benchmark reads of the configuration."""

    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)
    simulator: SimulatorSettings = field(default_factory=SimulatorSettings)
    gap: Gap = field(default_factory=Gap)
    prove: Proof = field(default_factory=Proof)


@dataclass(frozen=True)
class Task:
    """A case with all that its examination needs, as it travels to a process.

    Attributes:
        case: that is recorded and diagnosed.
        config: of the stages.
        sealed: where its key is written.
    """

    case: Any
    config: ProveStage
    sealed: Path


@stage(ProveStage)
def prove(config: ProveStage, run: StageRun) -> None:
    """Draw concealed cases, diagnose them, and score the answers against their sealed keys."""
    from pipeline.proof.page import results_text, write_docs
    from pipeline.proof.running import run_cases, write_whole
    from pipeline.proof.score import open_key, score_case

    tasks = _tasks(config)
    answers = run_cases(tasks, examine, _folder(config), config.prove.jobs, _identity)
    results = []
    for name, answer in answers.items():
        task = tasks[name]
        facts = {"name": name, "case": task.case.plain, "key": None} | answer
        if "source" in answer:
            facts["key"] = open_key(task.sealed, answer["source"])
            facts["score"] = score_case(facts["key"], answer.get("diagnosis"), task.case.wanted)
        results.append(facts)
    write_whole(results, run.output / "results.json")
    text = results_text(results, _command(config))
    (run.output / "proof.md").write_text(text, encoding="utf-8")
    print(text)
    if config.prove.write_docs:
        write_docs(results, _command(config))


def examine(task: Task, folder: Path) -> dict[str, Any]:
    """Record a case, seal its key, and diagnose the recording from what the person is told."""
    from stages.record import record_sealed

    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    answer: dict[str, Any] = {}
    with (folder / "log.txt").open("w") as log, redirect_stdout(log), redirect_stderr(log):
        start = time.perf_counter()
        try:
            answer["source"] = record_sealed(task.case, folder / "record" / "recording.parquet", task.sealed)
            answer["seconds_recording"] = time.perf_counter() - start
            answer |= _diagnosed(task, folder)
        except Exception as error:
            answer["failed"] = f"{type(error).__name__}: {error}"
            answer["traceback"] = traceback.format_exc()
    if not task.config.prove.keep:
        _tidy(folder)
    return answer


def _diagnosed(task: Task, folder: Path) -> dict[str, Any]:
    """Clean, build the nominal simulator and diagnose: what `simgap diagnose` does with a person's recording."""
    from stages.build_sim import BuildSimStage, build_sim
    from stages.clean import CleanStage, clean
    from stages.diagnose import DiagnoseStage, diagnose

    given, platform = task.config, task.case.platform
    branch = StageConfig(name=folder.name, artifacts=str(folder), seed=task.case.seed)
    common = vars(branch) | {"clean": given.clean, "dataset": given.dataset}
    wall, busy = time.perf_counter(), time.process_time()
    _run(clean, CleanStage(**common), folder)
    _run(build_sim, BuildSimStage(**vars(branch), platform=platform, simulator=given.simulator), folder)
    settings = DiagnoseStage(**common, platform=platform, simulator=given.simulator, gap=given.gap)
    _run(diagnose, settings, folder)
    return {
        "seconds": time.perf_counter() - wall,
        "seconds_busy": time.process_time() - busy,
        "diagnosis": json.loads((folder / "diagnose" / "diagnosis.json").read_text(encoding="utf-8")),
        "competition": json.loads(
            (folder / "diagnose" / "evidence" / "competition.json").read_text(encoding="utf-8")
        ),
    }


def _run(command: Stage[Any], settings: StageConfig, folder: Path) -> None:
    output = folder / command.name
    output.mkdir()
    command(settings, StageRun(output))


def _tidy(folder: Path) -> None:
    """Keep the log alone: the answer holds what is scored, and the recording can be made again from its seed."""
    for entry in folder.iterdir():
        if entry.is_dir():
            shutil.rmtree(entry)


def _tasks(config: ProveStage) -> dict[str, Task]:
    from pipeline.proof.settings import table_of
    from stages.record import draw_cases

    folder = _folder(config)
    tasks = {}
    for kind in config.prove.kinds:
        table = table_of(config.prove, kind)
        machines = {name: _platform_file(name) for name in table["machines"]}
        for case in draw_cases(kind, table, config.prove.shares, machines, config.seed, config.prove.cases):
            name = f"{kind}-{config.seed}-{case.number:04d}"
            tasks[name] = Task(case, config, folder.with_name(f"{folder.name}_keys") / f"{name}.json")
    return tasks


def _folder(config: ProveStage) -> Path:
    return Path(config.prove.folder or Path(config.artifacts) / "concealed")


def _platform_file(name: str) -> dict[str, Any]:
    from pipeline.stage.compose import compose

    return compose([f"platform={name}"])["platform"]


def _identity(task: Task) -> str:
    """Return what a result belongs to: the case as drawn, the settings, and the code that decides the answer."""
    from dataclasses import asdict

    from pipeline.artifacts import hash_value
    from pipeline.proof.settings import hash_of_code

    settings = {key: asdict(getattr(task.config, key)) for key in ("dataset", "clean", "simulator", "gap")}
    return hash_value([task.case.plain, settings, hash_of_code()])


def _command(config: ProveStage) -> str:
    kinds = ",".join(config.prove.kinds)
    return f"make prove SEED={config.seed} CASES={config.prove.cases} KIND={kinds}"


if __name__ == "__main__":
    prove.main()
