"""Registers that overflow and columns that stand still are mended, and said."""

import dataclasses

import numpy as np
import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.recordings.cleaning import clean_recording
from simgap.recordings.recording import Recording, recording_from_frame

STEP = 0.01
TIME = np.arange(0.0, 6.0, STEP)


def motion(seed: int = 0, size: float = 1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return a position and its exact velocity: a sum of sines."""
    random = np.random.default_rng(seed)
    rates, phases = random.uniform(0.3, 1.5, 5) * 2 * np.pi, random.uniform(0, 2 * np.pi, 5)
    waves = rates * TIME[:, None] + phases
    return size * np.sin(waves).sum(axis=1), size * (rates * np.cos(waves)).sum(axis=1)


def recording(position: np.ndarray, velocity: np.ndarray, **more: np.ndarray) -> Recording:
    runs = [
        pd.DataFrame(
            {
                "run": run,
                "t": TIME,
                "position": position,
                "velocity": velocity,
                "voltage": np.sin(TIME),
                **more,
            }
        )
        for run in ("one", "two")
    ]
    return recording_from_frame(pd.concat(runs, ignore_index=True), "joint")


def cleaned(raw: Recording) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    result = clean_recording(raw)[0]
    rows = result.frame[result.frame["run"] == "one"]
    return rows["position"].to_numpy(), rows["velocity"].to_numpy(), result.warnings


@settings(max_examples=6)
@given(st.integers(0, 1000))
def test_a_position_that_wraps_at_a_turn_is_unwrapped_exactly(seed):
    position, velocity = motion(seed, 5.0)
    wrapped = (position + np.pi) % (2 * np.pi) - np.pi
    mended, _, warnings = cleaned(recording(wrapped, velocity))
    turns = (mended - position) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns[0]), atol=1e-9)
    assert any("'position' wraps at 6.283" in warning for warning in warnings)


@pytest.mark.parametrize("bits", [12, 16])
def test_a_velocity_that_overflows_its_register_is_undone_exactly(bits):
    position, velocity = motion(1)
    quantum = 1.2 * np.abs(velocity).max() / 2**bits  # the register holds six tenths of the speeds
    ticks = np.round(velocity / quantum)
    register = (ticks + 2 ** (bits - 1)) % 2**bits - 2 ** (bits - 1)
    _, mended, warnings = cleaned(recording(position, register * quantum))
    np.testing.assert_allclose(mended, ticks * quantum, atol=0.05 * np.abs(velocity).max() / 100)
    assert any("'velocity' wraps at" in warning for warning in warnings)


@pytest.mark.parametrize("bits", [12, 15])
def test_a_sign_bit_is_read_as_a_sign(bits):
    position, velocity = motion(2)
    ticks = np.round(position / (2 * np.pi / 4096))
    register = np.where(ticks < 0, 2**bits - ticks, ticks)
    if register.max() >= 2 ** (bits + 1):
        pytest.skip("the motion does not fit into the register")
    mended, _, warnings = cleaned(recording(register * 2 * np.pi / 4096, velocity))
    np.testing.assert_allclose(mended, ticks * 2 * np.pi / 4096, atol=1e-6)
    assert any("'position' has its sign in its highest bit" in warning for warning in warnings)


@pytest.mark.parametrize("column", ["position", "velocity"])
def test_a_dead_stretch_is_left_out(column):
    position, velocity = motion(5)
    columns = {"position": position.copy(), "velocity": velocity.copy()}
    first = int(np.argmax(np.abs(velocity)))
    columns[column][first : first + 20] = columns[column][first]
    result = clean_recording(recording(**columns))[0]
    assert any(f"{column!r} repeats one value" in warning for warning in result.warnings)


def turning_slowly() -> tuple[np.ndarray, np.ndarray, slice]:
    """Return position and speed of an axis, and a quarter of a second about its highest speed."""
    velocity = 4.0 * np.sin(2.0 * TIME)
    position = 2.0 * (1.0 - np.cos(2.0 * TIME))
    first = int(np.argmax(velocity))
    return position, velocity, slice(first, first + round(0.25 / (TIME[1] - TIME[0])))


def test_a_speed_whose_noise_never_repeats_is_dead_where_it_is_off_by_little():
    position, velocity, held = turning_slowly()
    noisy = velocity + np.random.default_rng(0).normal(0.0, 1e-3, len(TIME))
    noisy[held] = noisy[held.start]
    assert np.abs(noisy - velocity).max() < 0.15 * velocity.max()
    result = clean_recording(recording(position, noisy))[0]
    assert any("'velocity' repeats one value" in warning for warning in result.warnings)


def test_a_coarse_speed_that_repeats_about_its_highest_is_not_dead():
    position, velocity, held = turning_slowly()
    coarse = np.round(velocity, 0)
    assert len(set(coarse[held])) == 1
    result = clean_recording(recording(position, coarse))[0]
    assert not any("repeats one value" in warning for warning in result.warnings)


def test_a_steady_speed_of_a_coarse_sensor_is_not_dead():
    velocity = np.round(np.clip(8.0 * np.sin(TIME), -4.0, 4.0), 1)
    position = np.concatenate([[0.0], np.cumsum(velocity[1:] * np.diff(TIME))])
    result = clean_recording(recording(position, velocity))[0]
    assert not any("repeats one value" in warning for warning in result.warnings)


def test_a_battery_of_no_voltage_is_left_out():
    position, velocity = motion(6)
    volts = np.full(len(TIME), 12.0) - 0.01 * TIME
    volts[100:150] = 0.0
    result = clean_recording(recording(position, velocity, battery_voltage=volts))[0]
    assert result.frame["battery_voltage"].min() > 11.0
    assert any("falls to 0 V in 50 samples" in warning for warning in result.warnings)


@settings(max_examples=6)
@given(st.integers(0, 1000), st.floats(0.2, 20.0))
def test_a_good_recording_stays_as_it_is(seed, size):
    position, velocity = motion(seed, size)
    raw = recording(position, velocity)
    result = clean_recording(raw)[0]
    assert result.warnings == raw.warnings
    np.testing.assert_array_equal(result.frame["position"], raw.frame["position"])
    np.testing.assert_array_equal(result.frame["velocity"], dataclasses.replace(raw).frame["velocity"])
