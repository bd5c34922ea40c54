"""The benchmark: simulated cases with sealed answer keys, and published recordings with known effects."""

from pathlib import Path
from typing import Any

from simgap.extras import require
from simgap.runner import StageRun, stage
from simgap.stages._benchmark_case import Concealed, Published, examine
from simgap.stages._prove_settings import ProveStage


@stage(ProveStage)
def prove(config: ProveStage, run: StageRun) -> None:
    """Measure the diagnosis: draw cases with concealed effects, diagnose them, score the answers."""
    from simgap.artifacts import require_checkout
    from simgap.benchmark.calibration import is_for_calibration
    from simgap.benchmark.page import results_text, write_docs
    from simgap.benchmark.running import run_cases, write_whole
    from simgap.errors import InputError

    if config.prove.write_docs:
        require_checkout("prove.write_docs=true")
    tasks: dict[str, Any] = _concealed(config) | _published(config)
    answers = run_cases(tasks, examine, _folder(config), config.prove.jobs, _identity)
    results = [_scored(name, tasks[name], answer, config) for name, answer in answers.items()]
    write_whole(results, run.output / "results.json")
    text = results_text(results, _command(config))
    (run.output / "proof.md").write_text(text, encoding="utf-8")
    print(text)
    if config.prove.write_docs:
        if is_for_calibration(config.seed):
            raise InputError(f"{config.seed} is a seed for calibration", "seed", "score with another")
        write_docs(results, _command(config))


def _concealed(config: ProveStage) -> dict[str, Concealed]:
    from simgap.benchmark.settings import table_of
    from simgap.stages.record import draw_cases

    folder = _folder(config)
    tasks = {}
    for kind in filter(lambda kind: kind != "real", config.prove.kinds):
        table = table_of(config.prove, kind)
        machines = {name: _composed(f"platform={name}")["platform"] for name in table["machines"]}
        for case in draw_cases(kind, table, config.prove.shares, machines, config.seed, config.prove.cases):
            name = f"{kind}-{config.seed}-{case.number:04d}"
            case = case.begun_later if config.prove.begins_later else case
            tasks[name] = Concealed(case, config, folder.with_name(f"{folder.name}_keys") / f"{name}.json")
    return tasks


def _published(config: ProveStage) -> dict[str, Published]:
    if "real" not in config.prove.kinds:
        return {}
    require("sklearn")
    return {
        f"real-{branch}": Published(
            branch, _composed(f"branch={branch}"), tuple(answer.get("ablate", ())), config.prove.keep
        )
        for branch, answer in config.prove.real.items()
    }


def _scored(
    name: str, task: Concealed | Published, answer: dict[str, Any], config: ProveStage
) -> dict[str, Any]:
    """Open the key, now that the answer is written, and score the answer."""
    from simgap.benchmark.published import score_published
    from simgap.benchmark.score import open_key, score_case

    if isinstance(task, Published):
        known = config.prove.real[task.branch]
        return {"name": name, "branch": task.branch, "score": score_published(known, answer)} | answer
    facts: dict[str, Any] = {"name": name, "seed": config.seed, "case": task.case.plain} | answer
    if "source" in answer:
        facts["key"] = open_key(task.sealed, answer["source"])
        facts["score"] = score_case(facts["key"], answer.get("diagnosis"), task.case.wanted)
    return facts


def _folder(config: ProveStage) -> Path:
    return Path(config.prove.folder or Path(config.artifacts) / "concealed")


def _composed(override: str) -> dict[str, Any]:
    from simgap.runner.compose import compose

    return compose([override])


def _identity(task: Concealed | Published) -> str:
    """Return the hash of all that an answer depends on: case, settings and code."""
    from simgap.artifacts import hash_value
    from simgap.benchmark.settings import hash_of_code

    return hash_value([task.identity, hash_of_code()])


def _command(config: ProveStage) -> str:
    kinds = ",".join(config.prove.kinds)
    if config.prove.begins_later:
        return (
            f"simgap prove seed={config.seed} prove.cases={config.prove.cases} 'prove.kinds=[{kinds}]' "
            "prove.begins_later=true"
        )
    return f"make prove SEED={config.seed} CASES={config.prove.cases} KIND={kinds}"


if __name__ == "__main__":
    from simgap.runner.command import main

    main(prove)
