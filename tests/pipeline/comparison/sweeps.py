"""Comparisons whose tables are known."""

from typing import Any

from simgap.comparison.comparison import Comparison, Job
from simgap.comparison.settings import Results


def job(error: float | None, seed: int = 0, **values: Any) -> Job:
    scores = {f"steps/motor_{number}/mse": float(number) for number in (1, 2)}
    errors = {} if error is None else {"h1": error, "h10": 10 * error}
    metrics = {f"position/{horizon}": value for horizon, value in errors.items()} | scores
    return Job({key.replace("__", "."): value for key, value in values.items()}, seed, metrics, seconds=30.0)


def sweep(*jobs: Job, **more: Any) -> Comparison:
    settings = Results(**more.pop("results", {}))
    return Comparison("imagined", "simgap train -m …", "2 cores", list(jobs), results=settings, **more)


def lengths() -> Comparison:
    """Return two models, two lengths, two seeds: errors of 1 and 3, and of half of that for the TCN."""
    jobs = [
        job(share * error, seed, model=model, model__sequence_length=length)
        for model, share in (("lstm", 1.0), ("tcn", 0.5))
        for length in (5, 10)
        for seed, error in ((0, 1.0), (1, 3.0))
    ]
    return sweep(*jobs, references={"persistence": {"position/h1": 8.0, "position/h10": 80.0}})
