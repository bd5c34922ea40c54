"""How much runs resemble each other."""

import numpy as np
import pandas as pd
from hypothesis import given
from hypothesis import strategies as st

from simgap.recordings.resemblance import distances_of


def runs(*motions: np.ndarray, **others: float) -> pd.DataFrame:
    """Return runs of one channel each, with others that stay."""
    frames = [
        pd.DataFrame(
            {"run": f"run{number}", "t": 0.01 * np.arange(len(motion)), "velocity": motion, **others}
        )
        for number, motion in enumerate(motions)
    ]
    return pd.concat(frames, ignore_index=True)


def noise(seed: int, size: float = 1.0) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(500)


def test_runs_of_the_like_are_near_and_others_far():
    slow = np.sin(0.01 * np.arange(500))
    apart = distances_of(runs(noise(0), noise(1), slow, noise(2, 0.1)))
    assert apart[0, 1] == apart[np.triu_indices(4, 1)].min()
    assert (apart[[0, 1], 2] > 5 * apart[0, 1]).all()
    assert (apart[[0, 1], 3] > 5 * apart[0, 1]).all()


@given(seed=st.integers(0, 1000), scale=st.floats(1e-3, 1e3), shift=st.floats(-1e3, 1e3))
def test_units_do_not_matter(seed, scale, shift):
    frame = runs(noise(seed), noise(seed + 1, 2.0), noise(seed + 2, 0.5))
    other = frame.assign(velocity=scale * (frame["velocity"] + shift))
    np.testing.assert_allclose(distances_of(other), distances_of(frame), atol=1e-5)


def test_what_never_changes_or_is_missing_somewhere_says_nothing():
    frame = runs(noise(0), noise(1, 3.0), voltage=12.0)
    more = frame.assign(torque=frame["velocity"].where(frame["run"] == "run0"))
    np.testing.assert_allclose(distances_of(more), distances_of(frame[["run", "t", "velocity"]]))


def test_equal_runs_are_not_apart():
    assert not distances_of(runs(noise(0), noise(0))).any()
    assert distances_of(runs(noise(0)[:1])).tolist() == [[0.0]]
