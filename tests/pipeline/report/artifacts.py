"""Artifacts of an imagined pipeline run, seeded: every verdict, nulls, empty lists and hostile text."""

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import yaml

from simgap.comparison.comparison import Comparison, Job
from simgap.comparison.figure import FIGURE, draw
from simgap.comparison.settings import Results, TableOf
from simgap.models.residual_figure import residual_figure
from tests.pipeline.report.diagnoses import RUNS, diagnosis
from tests.pipeline.report.evidence import write_evidence, write_json

HOSTILE = '</script><script>window.hacked=1</script><img src=x onerror="window.hacked=2"><b>&amp;{{7*7}}"\'`'
MODELS = (("lstm", 0, 2.0), ("lstm", 1, 4.0), ("tcn", 0, 1.0), ("tcn", 1, 2.0))  # model, seed, error
TRAINED = ("square_run1", "square_run2", "random1_run1", "multisine_run1")


def make_branch(
    folder: Path, verdict: str = "missing_physics", *, bare: bool = False, text: str = ""
) -> Path:
    """Write a branch's artifacts; `bare`: empty lists and nulls; `text`: put wherever text goes."""
    random = np.random.default_rng(7)
    diagnose, evidence = folder / "diagnose", folder / "diagnose" / "evidence"
    evidence.mkdir(parents=True)
    write_json(diagnose / "diagnosis.json", diagnosis(verdict, bare=bare, text=text))
    if bare:
        for file in ("hypotheses.json", "candidates.json", "laws.json", "horizon.json", "regimes.json"):
            write_json(evidence / file, [])
        return folder
    write_evidence(evidence, verdict, text, random)
    _clean(folder / "clean", text, random)
    _identified(folder, text)
    return folder


def _clean(folder: Path, text: str, random: np.random.Generator) -> None:
    folder.mkdir(parents=True)
    runs = [text or RUNS[0], *RUNS[1:], *TRAINED]
    changes = [
        {
            "run": run,
            "step": step,
            "column": column,
            "reason": text or reason,
            "samples": int(random.integers(1, 300)),
            "seconds": float(random.uniform(0.01, 3)),
            "detail": text or "longest 0.12 s",
        }
        for run in runs
        for step, column, reason in (
            ("resample", None, "put on a uniform grid of 10 ms"),
            ("frozen", "motor_speed_2", "value held for more than 5 samples"),
            ("spikes", "motor_speed_4", "jump beyond what the motor can do"),
        )
    ]
    pd.DataFrame(changes).to_parquet(folder / "changes.parquet")
    stretches = [
        ("dropped", 0, 2, "idle"),
        ("kept", 2, 30, ""),
        ("interpolated", 30, 30.4, "gap"),
        ("kept", 30.4, 60, ""),
    ]
    coverage = [
        {"run": run, "start": 12.5 + start, "end": 12.5 + end, "state": state, "reason": text or reason}
        for run in runs
        for state, start, end, reason in stretches
    ]
    pd.DataFrame(coverage).to_parquet(folder / "coverage.parquet")
    split = dict.fromkeys(runs[:3], "holdout") | dict.fromkeys(runs[3:6], "train") | {runs[6]: "validation"}
    metadata = {
        "platform_kind": "quadrotor",
        "source": text or "imagined flights of a 45 g quadrotor",
        "licence": text or "none stated: evaluate and cite",
        "simgap.split": json.dumps(split),
    }
    pq.write_table(pa.table({"run": runs}).replace_schema_metadata(metadata), folder / "recording.parquet")


def _identified(folder: Path, text: str) -> None:
    thrust = {"value": 3.7178e-8, "std": 2.4e-11, "unit": "N/(rad/s)^2", "nominal": 3.72e-8}
    inertia = {
        "value": [2.4e-5, 2.5e-5, 3.2e-5],
        "std": [1e-6, 2e-6, 4e-6],
        "unit": "kg*m^2",
        "note": text or "z is weakly excited",
    }
    motors = {f"motor_{index}": {"mse": 0.0123 * index, "mae": 0.08, "r2": 0.998} for index in range(1, 5)}
    (folder / "sysid").mkdir()
    (folder / "sysid" / "parameters.yaml").write_text(
        yaml.safe_dump({"thrust_coefficient": thrust, "inertia": inertia})
    )
    write_json(folder / "sysid" / "metrics.json", {"samples": 55_599, "r2": 0.987} | motors)
    (folder / "train").mkdir()
    write_json(
        folder / "train" / "metrics.json",
        {
            "epochs": 40,
            "position": {"h1": {"model": 0.001, "naive": 0.004}, "sum": {"model": None, "naive": 4.0}},
            "steps": {"velocity_x": {"mse": 0.25, "r_squared": 0.9, "increment_r_squared": None}},
        },
    )
    figure = residual_figure({text or "velocity_x": np.linspace(-1.0, 1.0, 100)}, {}, {})
    (folder / "train" / "residuals.svg").write_text(figure, encoding="utf-8")


def make_sweep(branch: Path, text: str = "") -> Path:
    """Write what a sweep of two models has shown, with text wherever text goes."""
    folder = branch / "sweeps" / "train" / "comparison"
    folder.mkdir(parents=True)
    jobs = [Job({"model": text + model}, seed, {"position/h1": error}) for model, seed, error in MODELS]
    settings = Results(text or "Two models", text, [TableOf("position/h1", text)], baseline={"model": "lstm"})
    failed = [text] if text else ["model=x: no"]
    comparison = Comparison(
        text or "train", text, text, jobs, {text or "persistence": {"position/h1": 9.0}}, failed, settings
    )
    comparison.write(folder)
    draw(comparison, folder / FIGURE)
    return folder
