"""How strongly every concealed effect shows, so that `conf/prove` can say what is clear and what is faint."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from pipeline.gap.settings import Gap
from pipeline.proof.settings import Proof
from pipeline.recordings.cleaning.settings import Cleaning
from pipeline.recordings.dataset import Dataset
from pipeline.stage import StageConfig, StageRun, stage


@dataclass
class StrengthsStage(StageConfig):
    """What the measurement reads of the configuration."""

    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)
    gap: Gap = field(default_factory=Gap)
    prove: Proof = field(default_factory=Proof)


@dataclass(frozen=True)
class Task:
    """One effect on one machine, as it travels to a process."""

    config: StrengthsStage
    kind: str
    effect: str
    machine: str


@stage(StrengthsStage)
def strengths(config: StrengthsStage, run: StageRun) -> None:
    """Measure the energy that each concealed effect adds to the residual, over the noise's, and say what is faint."""
    from pipeline.artifacts import hash_value
    from pipeline.proof.running import run_cases, write_whole
    from pipeline.proof.settings import hash_of_code
    from pipeline.proof.strengths import strengths_text

    tasks = {f"{t.kind}-{t.effect}-{t.machine}": t for t in _tasks(config)}
    folder = Path(config.artifacts) / "shown"

    def identity(task: Task) -> str:
        return hash_value([str(task), hash_of_code()])

    results = run_cases(tasks, measure, folder, config.prove.jobs, identity)
    entries = [
        {"kind": task.kind, "effect": task.effect, "machine": task.machine} | results[name]
        for name, task in tasks.items()
    ]
    write_whole(entries, run.output / "strengths.json")
    print(strengths_text(entries))


def measure(task: Task, folder: Path) -> dict[str, Any]:
    """Return by strength the energies over the noise's: what the effect explains, and what is left with it known."""
    entry = getattr(task.config.prove, task.kind)["effects"][task.effect]
    given = [entry[key] for key in ("clear", "faint") if key in entry]
    own = [value[task.machine] if isinstance(value, dict) else value for value in given]
    strengths = sorted({1.0, *map(float, own)})
    return {"energies": {f"{strength:g}": _energies(task, strength, folder) for strength in strengths}}


def _energies(task: Task, strength: float, folder: Path) -> dict[str, float]:
    """Return the energy over the noise's that the effect explains where it explains most, and what it leaves there.

    One recording, two simulators: one that knows all that is concealed, one that lacks the effect alone.
    """
    import torch

    from pipeline.gap.preparation import prepare
    from pipeline.gap.residuals import noise_of_rows, residual_rows
    from pipeline.recordings.cleaning import clean_with_coverage
    from pipeline.simulation.build import build_simulator
    from pipeline.simulation.settings import SimulatorSettings

    torch.set_num_threads(1)
    recording, told, effects = _recorded(task, strength, folder)
    config = task.config
    cleaned = clean_with_coverage(recording, config.clean, config.dataset.split, config.seed).recording
    nominal = build_simulator(told, SimulatorSettings(), cleaned.units)
    prepared = prepare(cleaned, nominal, config.gap)
    blocks, functions = prepared.problem.blocks, prepared.problem.functions
    without = {key: values for key, values in effects.items() if not _is_of(key, task.effect)}
    simulators = [
        replace(
            build_simulator(told, SimulatorSettings(effects=known), cleaned.units),
            settings=prepared.nominal.settings,
        )
        for known in (effects, without)
    ]
    noise = noise_of_rows(simulators[0], blocks, functions)
    complete, lacking = (
        (residual_rows(s, blocks, functions) / noise).square().mean((0, 1)) for s in simulators
    )
    place = int((lacking - complete).argmax())
    return {"explained": float((lacking - complete)[place]), "left": float(complete[place])}


def _recorded(task: Task, strength: float, folder: Path) -> tuple[Any, dict[str, Any], dict[str, Any]]:
    """Record one effect alone at a strength, on the machine as its file has it.

    Returns:
        The recording, what the person is told of the machine, and what the catalogue's effects of the key amount to.
    """
    import json

    from pipeline.proof.score import effect_name
    from pipeline.recordings.recording import read_recording
    from pipeline.stage.compose import compose
    from stages.record import draw_cases, record_sealed

    table = getattr(task.config.prove, task.kind)
    entry = table["effects"][task.effect] | {"clear": strength, "faint": strength}
    beside = {name: table["effects"][name] for name in entry.get("beside", ())}
    alone: dict[str, Any] = {"effects": {task.effect: entry} | beside}
    alone |= {"machines": {task.machine: table["machines"][task.machine]}, "conditions": table["conditions"]}
    machines = {task.machine: compose([f"platform={task.machine}"])["platform"]}
    shares = {"clear": 1.0, "decoy": 1.0}
    cases = draw_cases(task.kind, alone, shares, machines, task.config.seed, len(alone["effects"]))
    case = next(case for case in cases if case.subject.names == (task.effect,))
    record_sealed(case, folder / "recording.parquet", folder / "key.json")
    key = json.loads((folder / "key.json").read_text(encoding="utf-8"))
    effects = {}
    for effect in key["effects"]:
        values = {name: entry["value"] for name, entry in effect["parameters"].items()}
        effects[_key_of(task.kind, effect_name(effect), values)] = values
    return read_recording(folder / "recording.parquet"), case.platform, effects


def _key_of(kind: str, name: str, values: dict[str, float]) -> str:
    """Return the catalogue's key of a concealed effect: one name may stand for each of four rotors."""
    from pipeline.effects import effects_of

    alike = [effect for effect in effects_of(kind) if _is_of(effect.key, name)]
    return next(e.key for e in alike if set(values) <= {parameter.name for parameter in e.parameters})


def _is_of(key: str, name: str) -> bool:
    return key == name or key.partition("@")[0] == name


def _tasks(config: StrengthsStage) -> list[Task]:
    slim = replace(config, output=None)
    return [
        Task(slim, kind, effect, machine)
        for kind in config.prove.kinds
        for effect, entry in getattr(config.prove, kind)["effects"].items()
        for machine in entry.get("machines", getattr(config.prove, kind)["machines"])
    ]


if __name__ == "__main__":
    strengths.main()
