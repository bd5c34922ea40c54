"""One benchmark case in a process of its own: record, clean, build the simulator, diagnose."""

import json
import shutil
import time
import traceback
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from simgap.runner import Stage, StageRun
from simgap.stages._prove_settings import ProveStage


@dataclass(frozen=True)
class Concealed:
    """A simulated case with concealed effects, and everything that its process needs.

    Attributes:
        case: what is recorded and diagnosed.
        config: configuration of the stages.
        sealed: where the answer key is written.
    """

    case: Any
    config: ProveStage
    sealed: Path

    @property
    def identity(self) -> Any:
        """What the answer depends on besides the code."""
        settings = {
            key: asdict(getattr(self.config, key)) for key in ("dataset", "clean", "simulator", "gap")
        }
        return [self.case.plain, settings]


@dataclass(frozen=True)
class Published:
    """A real recording with known effects.

    Attributes:
        branch: branch of the pipeline.
        values: its composed configuration.
        ablate: effects that are removed from the fitted simulator one at a time; each must be named again.
        keep: whether recordings and reports are kept.
    """

    branch: str
    values: dict[str, Any]
    ablate: tuple[str, ...]
    keep: bool

    @property
    def identity(self) -> Any:
        """What the answer depends on besides the code."""
        sections = ("platform", "dataset", "clean", "simulator", "gap")
        return [self.branch, self.ablate, {key: self.values[key] for key in sections}]


def examine(task: Concealed | Published, folder: Path) -> dict[str, Any]:
    """Run a task in an empty folder and return its answer; an error becomes part of the answer."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    answer: dict[str, Any] = {}
    keep = task.config.prove.keep if isinstance(task, Concealed) else task.keep
    with (folder / "log.txt").open("w") as log, redirect_stdout(log), redirect_stderr(log):
        try:
            if isinstance(task, Concealed):
                _examine_concealed(task, folder, answer)
            else:
                _examine_published(task, folder, answer)
        except Exception as error:
            answer["failed"] = f"{type(error).__name__}: {error}"
            answer["traceback"] = traceback.format_exc()
    if not keep:
        for entry in filter(Path.is_dir, folder.iterdir()):
            shutil.rmtree(entry)
    return answer


def _examine_concealed(task: Concealed, folder: Path, answer: dict[str, Any]) -> None:
    """Set the effect sizes of a case, record it, seal its key, and diagnose the recording with what a user would know.

    The case is left out if its effects cannot reach the size that its category demands.
    """
    from simgap.benchmark.strength import is_settled
    from simgap.gap.calibration import hash_of_score
    from simgap.stages._strengths import settled
    from simgap.stages.record import record_sealed

    start = time.perf_counter()
    case, answer["energies"] = settled(task.case, task.config)
    if not all(is_settled(energy, case.subject.strength) for energy in answer["energies"].values()):
        return
    answer["source"] = record_sealed(case, folder / "record" / "recording.parquet", task.sealed)
    answer["seconds_recording"] = time.perf_counter() - start
    answer["code"] = hash_of_score()  # what calibration is fitted to has to be of one version
    sections = ("dataset", "clean", "simulator", "gap")
    values = {key: asdict(getattr(task.config, key)) for key in sections}
    values |= {"platform": case.platform, "seed": case.seed}
    answer |= _timed(partial(_diagnosed, values, folder, ("clean", "build_sim", "diagnose")))


def _examine_published(task: Published, folder: Path, answer: dict[str, Any]) -> None:
    """Diagnose a published recording; then remove named effects one at a time and diagnose again."""
    from simgap.simulation import read_simulator

    _diagnosed(task.values, folder, ("record", "clean"))
    answer |= _timed(partial(_diagnosed, task.values, folder, ("build_sim", "diagnose")))
    answer["explained"] = _explained(answer["diagnosis"], folder / "diagnose" / "evidence")
    fitted = read_simulator(folder / "diagnose" / "simulator")
    named = {effect.effect.key: dict(effect.values) for effect in fitted.free}
    known = task.values["simulator"]["effects"] or {}
    answer["ablated"] = {}
    for name in filter(named.__contains__, task.ablate):
        others = {key: values for key, values in named.items() if key != name}
        given = {key: values for key, values in known.items() if key != name}
        simulator = task.values["simulator"] | {"effects": given | others}
        place = folder / f"without_{name}"
        shutil.copytree(folder / "clean", place / "clean")
        values = task.values | {"simulator": simulator}
        answer["ablated"][name] = _timed(partial(_diagnosed, values, place, ("build_sim", "diagnose")))


def _explained(diagnosis: dict[str, Any], evidence: Path) -> dict[str, float] | None:
    """Return what names and a flexible regression explain on held-out runs; None where nothing was held out."""
    from simgap.benchmark.flexible import explained

    if not diagnosis["fit"]["held_out_runs"]:
        return None
    found = explained(evidence, [mismatch["channel"] for mismatch in diagnosis["mismatch"]])
    return asdict(found) if found else None


def _timed(work: Callable[[], dict[str, Any]]) -> dict[str, Any]:
    wall, busy = time.perf_counter(), time.process_time()
    done = work()
    return done | {"seconds": time.perf_counter() - wall, "seconds_busy": time.process_time() - busy}


def _diagnosed(values: dict[str, Any], folder: Path, commands: tuple[str, ...]) -> dict[str, Any]:
    """Run stages on a folder of artifacts.

    Returns:
        The `diagnosis`, the `posterior` and `shares`, each where there is one. The posterior holds the probability of
        each effect before recalibration, by key; `shares` those of the error that each possible one explains.
    """
    from importlib import import_module

    from simgap.runner.compose import typed

    places = {"name": folder.name, "artifacts": str(folder), "output": None, "recording": None}
    for name in commands:
        command: Stage[Any] = getattr(import_module(f"simgap.stages.{name}"), name)
        output = folder / name
        output.mkdir(parents=True)
        command(typed(command.config_class, values | places), StageRun(output))
    diagnosis = _read(folder / "diagnose" / "diagnosis.json")
    posterior = _read(folder / "diagnose" / "evidence" / "posterior.json")
    told = posterior or {}
    answer = {
        "diagnosis": diagnosis,
        "posterior": told.get("probabilities"),
        "shares": told.get("shares"),
    }
    return {key: value for key, value in answer.items() if value is not None}


def _read(path: Path) -> dict[str, Any] | None:
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None
