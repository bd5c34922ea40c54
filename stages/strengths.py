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
    section: str


@stage(StrengthsStage)
def strengths(config: StrengthsStage, run: StageRun) -> None:
    """Measure the energy that each concealed effect adds to the residual, over the noise's, and say what is faint."""
    from pipeline.artifacts import hash_value
    from pipeline.proof.running import run_cases, write_whole
    from pipeline.proof.settings import hash_of_code
    from pipeline.proof.strengths import strengths_text

    tasks = {f"{t.kind}-{t.section}-{t.effect}-{t.machine}": t for t in _tasks(config)}
    folder = Path(config.artifacts) / "shown"

    def identity(task: Task) -> str:
        return hash_value([str(task), hash_of_code()])

    results = run_cases(tasks, measure, folder, config.prove.jobs, identity)
    entries = [
        {"kind": task.kind, "section": task.section, "effect": task.effect, "machine": task.machine}
        | results[name]
        for name, task in tasks.items()
    ]
    write_whole(entries, run.output / "strengths.json")
    print(strengths_text(entries))


def measure(task: Task, folder: Path) -> dict[str, Any]:
    """Return the energy over the noise's, in the channel where it shows most, by strength."""
    entry = getattr(task.config.prove, task.kind)[task.section][task.effect]
    silent = _energies(task, 0.0, None, folder)
    energies = {}
    for strength in sorted({1.0, *(float(entry[key]) for key in ("clear", "faint") if key in entry)}):
        added = _energies(task, strength, silent["noise"], folder)["energy"] - silent["energy"]
        energies[f"{strength:g}"] = float(added.max())
    return {"energies": energies}


def _energies(task: Task, strength: float, noise: Any, folder: Path) -> dict[str, Any]:
    """Return the residual's energy per channel over the noise's, and the noise."""
    import torch

    from pipeline.gap.residuals import noise_of_rows, residual_rows
    from pipeline.gap.timing import cut_settled_blocks
    from pipeline.physics.weak_form import window_functions
    from pipeline.recordings.cleaning import clean_with_coverage
    from pipeline.simulation.build import build_simulator
    from pipeline.simulation.settings import SimulatorSettings

    torch.set_num_threads(1)
    recording, told = _recorded(task, strength, folder)
    config = task.config
    cleaned = clean_with_coverage(recording, config.clean, config.dataset.split, config.seed).recording
    nominal = build_simulator(told, SimulatorSettings(), cleaned.units)
    blocks = cut_settled_blocks(cleaned, nominal.platform, config.gap)
    functions = window_functions(blocks.samples, config.gap.test_width, blocks.time_step)
    noise = noise_of_rows(nominal, blocks, functions) if noise is None else noise
    return {
        "noise": noise,
        "energy": (residual_rows(nominal, blocks, functions) / noise).square().mean((0, 1)),
    }


def _recorded(task: Task, strength: float, folder: Path) -> tuple[Any, dict[str, Any]]:
    """Record one effect alone at a strength, on the machine as its file has it; return what the person is told too."""
    from pipeline.recordings.recording import read_recording
    from pipeline.stage.compose import compose
    from stages.record import draw_cases, record_sealed

    table = getattr(task.config.prove, task.kind)
    entry = table[task.section][task.effect] | {"clear": strength, "faint": strength}
    alone: dict[str, Any] = {"effects": {}, "outside": {}} | {task.section: {task.effect: entry}}
    alone |= {"machines": {task.machine: table["machines"][task.machine]}, "conditions": table["conditions"]}
    machines = {task.machine: compose([f"platform={task.machine}"])["platform"]}
    shares = {"clear": 1.0, "decoy": 1.0, "outside": 1.0}
    (case,) = draw_cases(task.kind, alone, shares, machines, task.config.seed, 1)
    record_sealed(case, folder / "recording.parquet", folder / "key.json")
    return read_recording(folder / "recording.parquet"), case.platform


def _tasks(config: StrengthsStage) -> list[Task]:
    slim = replace(config, output=None)
    return [
        Task(slim, kind, effect, machine, section)
        for kind in config.prove.kinds
        for section in ("effects", "outside")
        for effect, entry in getattr(config.prove, kind)[section].items()
        for machine in entry.get("machines", getattr(config.prove, kind)["machines"])
    ]


if __name__ == "__main__":
    strengths.main()
