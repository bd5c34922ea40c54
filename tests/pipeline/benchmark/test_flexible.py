"""What a flexible regression explains of the error of a simulator, against laws that are known."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simgap.benchmark.flexible import explained

WINDOWS = 150
NOISE = 0.1


def evidence(folder: Path, law, left: float = 0.0, runs: int = 8) -> Path:
    """Write the windows of some runs, a quarter of them held out: a law of the velocity, of which a share is left."""
    random = np.random.default_rng(3)
    tables = []
    for number in range(runs):
        t = 0.1 * np.arange(WINDOWS)
        velocity = np.sin(t * random.uniform(0.5, 1.5) + random.uniform(0.0, 6.0))
        voltage = random.normal(size=WINDOWS)
        cause = law(velocity, voltage)
        noise = NOISE * random.standard_normal(WINDOWS)
        part = "holdout" if number >= runs - runs // 4 else "train"
        windows = {"t": t, "velocity": velocity, "voltage": voltage}
        errors = {"before": cause + noise, "after": left * cause + noise}
        tables.append(pd.DataFrame(windows | {"run": str(number), "part": part} | errors))
    table = pd.concat(tables).assign(channel="torque", unit="N·m")
    other = table.assign(channel="force", unit="N", before=1.0, after=1.0)
    pd.concat([table, other]).to_parquet(folder / "residuals.parquet")
    return folder


def bent(velocity, voltage):
    return np.abs(velocity) * velocity - 0.5 * np.sign(velocity)


def remembered(velocity, voltage):
    return np.concatenate([[0.0, 0.0], voltage[:-2]])


def inertial(velocity, voltage):
    return np.gradient(velocity) / 0.1


@pytest.mark.parametrize("law", [bent, remembered])
def test_a_law_of_the_signals_is_explained_by_its_name_and_by_a_regression(tmp_path, law):
    found = explained(evidence(tmp_path, law), ["torque"])
    assert found.flexible > 0.5
    assert found.named > found.flexible - 0.05
    assert found.enough


def test_a_law_without_a_name_is_explained_by_the_regression_alone(tmp_path):
    found = explained(evidence(tmp_path, bent, left=1.0), ["torque"])
    assert found.named == 0.0
    assert found.flexible > 0.5
    assert not found.enough


def test_what_is_measured_is_not_explained_by_the_change_of_the_motion(tmp_path):
    assert explained(evidence(tmp_path, inertial, left=1.0), ["torque"]).flexible < 0.2


def test_noise_explains_nothing_and_nothing_has_to_be_named(tmp_path):
    found = explained(evidence(tmp_path, lambda velocity, voltage: 0.0 * velocity, left=1.0), ["torque"])
    assert found.flexible < 0.05
    assert found.enough


def test_nothing_is_said_without_held_out_runs(tmp_path):
    assert explained(evidence(tmp_path, bent, runs=3), ["torque"]) is None
