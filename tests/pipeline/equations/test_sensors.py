"""A velocity that is late with respect to its position is shifted, in the runs in which it is."""

import numpy as np
import pandas as pd
import pytest
import torch

from simgap.equations.sensors import settle_velocity
from simgap.platforms import Joint
from simgap.recordings.recording import Recording
from simgap.simulation.blocks import Blocks, cut_blocks

STEP, WIDTH = 0.01, 0.2


def swinging(late: dict[str, float]) -> Blocks:
    """Return runs of a joint whose velocity is late by so many seconds."""
    t = np.arange(0.0, 6.0, STEP)
    frames = [
        pd.DataFrame(
            {"run": run, "t": t, "position": np.sin(3.0 * t), "velocity": 3.0 * np.cos(3.0 * (t - by))}
        )
        for run, by in late.items()
    ]
    frame = pd.concat(frames, ignore_index=True).assign(segment=0, filled=0, effort=0.0)
    units = {"position": "rad", "velocity": "rad/s", "effort": "N·m"}
    return cut_blocks(Recording(frame, "joint", units, cleaned=True), Joint(0.01), 1.0, 0.3, held=False)


def error_of(blocks: Blocks) -> torch.Tensor:
    """Return the greatest error of the velocity in each block but those at an end of a run, which have no neighbour."""
    time = blocks.start[:, None] + STEP * torch.arange(blocks.samples)
    error = (blocks.inner(blocks.signals["velocity"]) - 3.0 * torch.cos(3.0 * time)).abs().amax(1)
    return error[(blocks.start > 0.5) & (blocks.start < 4.5)]


@pytest.mark.parametrize("by", [0.05, -0.08, 0.2])
def test_a_shift_of_all_runs_is_removed_and_said(by):
    settled, (said,) = settle_velocity(swinging({"a": by, "b": by}), WIDTH)
    assert float(error_of(settled).max()) < 1e-6
    assert f"{abs(by):.3g} s {'late' if by > 0 else 'early'} relative to the position;" in said


def test_a_run_that_is_on_time_stays_so_beside_late_ones():
    settled, (said,) = settle_velocity(swinging({"a": 0.06, "b": 0.0, "c": 0.06}), WIDTH)
    assert float(error_of(settled).max()) < 1e-6
    assert "in 2 of 3 runs" in said


def test_nothing_is_shifted_that_is_on_time():
    blocks = swinging({"a": 0.0, "b": 0.0})
    settled, said = settle_velocity(blocks, WIDTH)
    assert settled is blocks
    assert said == []
