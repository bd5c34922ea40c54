"""Filters without delay: gain and phase of known waves, and what they leave alone."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.models.zero_phase import zero_phase
from tests.pipeline.models import learnable
from tests.pipeline.models.synthetic import recording

TIME = 0.01 * np.arange(1000)
INSIDE = slice(200, -200)  # where the ends are forgotten


def joint(velocity, segment=0):
    columns = {
        "run": "a",
        "t": TIME,
        "segment": segment,
        "position": 0.0,
        "velocity": velocity,
        "effort": 0.0,
    }
    return recording(pd.DataFrame(columns), "joint")


@pytest.mark.parametrize(("frequency", "gain"), [(0.5, 1.0), (10.0, 0.5), (40.0, 0.0)])
def test_a_wave_keeps_its_phase_and_loses_half_at_the_cut_off(frequency, gain):
    wave = np.sin(2 * np.pi * frequency * TIME + 0.3)
    filtered = zero_phase(joint(wave), {"velocity": 10.0}).frame["velocity"].to_numpy()
    assert np.allclose(filtered[INSIDE], gain * wave[INSIDE], atol=2e-3)


def test_segments_do_not_meet_and_other_channels_stay():
    step = np.where(np.arange(1000) < 500, 0.0, 1.0)
    filtered = zero_phase(joint(step, segment=step.astype(int)), {"velocity": 10.0}).frame
    assert np.allclose(filtered["velocity"], step, atol=1e-9)
    assert (filtered["position"] == 0.0).all()


def test_segments_of_a_few_samples_are_filtered_too():
    short = zero_phase(joint(np.ones(1000), segment=np.arange(1000) // 3), {"velocity": 10.0})
    assert np.allclose(short.frame["velocity"], 1.0)


def test_an_attitude_is_filtered_whichever_sign_was_recorded():
    flight = learnable.quadrotor()
    names = [f"attitude_{axis}" for axis in "wxyz"]
    turned = flight.frame.copy()
    turned.loc[100:150, names] *= -1.0
    one, other = (
        zero_phase(replace(flight, frame=frame), {"attitude": 12.0}).frame[names].to_numpy()
        for frame in (flight.frame, turned)
    )
    assert np.allclose(np.linalg.norm(one, axis=1), 1.0)
    assert np.allclose(np.abs(np.sum(one * other, axis=1)), 1.0)


@pytest.mark.parametrize(
    ("frequencies", "complaint"),
    [
        ({"speed": 10.0}, r"train\.zero_phase\.speed: is not a channel"),
        ({"velocity": 60.0}, r"train\.zero_phase\.velocity: 60 Hz is not between"),
        ({"velocity": 0.0}, r"train\.zero_phase\.velocity: 0 Hz is not between"),
    ],
)
def test_filters_that_cannot_be_are_refused(frequencies, complaint):
    with pytest.raises(InputError, match=complaint):
        zero_phase(joint(TIME), frequencies)
