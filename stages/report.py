"""The stage that writes the page of a pipeline run."""

import json
from dataclasses import dataclass, field
from pathlib import Path

from simgap.report import Drawing, ReportInputs, write_page
from simgap.report.text import is_number
from simgap.runner import StageConfig, StageRun, stage

FINAL = ("gap_closed", "before", "after", "noise_floor")


@dataclass
class ReportStage(StageConfig):
    """The configuration of the report."""

    report: Drawing = field(default_factory=Drawing)


@stage(ReportStage)
def report(config: ReportStage, run: StageRun) -> None:
    """Write one self-contained page: the verdict, its evidence, and the origin of the data."""
    simulator = f"{config.artifact('diagnose', 'simulator')}"
    inputs = ReportInputs.of_branch(Path(config.artifacts), config.name, simulator)
    for folder in inputs.folders:
        run.input(folder)
    write_page(inputs, run.output / "report.html", config.report)
    final = final_numbers(inputs)
    (run.output / "metrics.json").write_text(json.dumps(final, indent=2, allow_nan=False) + "\n")
    numbers = {key: value for key, value in final.items() if is_number(value)}
    run.log_metrics(numbers)
    run.log_results(numbers)


def final_numbers(inputs: ReportInputs) -> dict[str, float | str | None]:
    """Return verdict, errors and share of the gap closed; empty where there was no diagnosis."""
    if inputs.diagnosis is None:
        return {}
    fit = inputs.diagnosis.get("fit") or {}
    return {"verdict": inputs.diagnosis["verdict"]} | {key: fit.get(key) for key in FINAL}


if __name__ == "__main__":
    from simgap.runner.command import main

    main(report)
