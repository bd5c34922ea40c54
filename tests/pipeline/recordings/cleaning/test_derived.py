"""A velocity that nobody recorded is the slope of the position."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.recordings import Recording, read_recording, write_recording
from simgap.recordings.cleaning import clean_recording
from simgap.recordings.cleaning.derived import derivative
from simgap.recordings.recording import recording_from_frame


@given(st.lists(st.floats(-3, 3), min_size=5, max_size=5), st.integers(2, 40), st.floats(1e-3, 0.1))
def test_the_slope_of_a_quartic_is_exact_up_to_the_ends(coefficients, samples, step):
    time = np.arange(samples) * step
    polynomial = np.polynomial.Polynomial(coefficients if samples >= 5 else coefficients[:2])
    np.testing.assert_allclose(derivative(polynomial(time), step), polynomial.deriv()(time), atol=1e-8)


def test_a_sine_of_a_tenth_of_the_rate_loses_less_than_a_hundredth():
    time = np.arange(200) / 30.0
    found = derivative(np.sin(6.0 * np.pi * time), 1 / 30.0)
    np.testing.assert_allclose(found[2:-2], 6.0 * np.pi * np.cos(6.0 * np.pi * time)[2:-2], atol=0.1 * np.pi)


def told(runs: int = 2, **columns: float) -> pd.DataFrame:
    time = np.arange(300) / 50.0
    frames = [
        pd.DataFrame({"run": f"r{run}", "t": time, "position": np.sin(2.0 * time + run)}).assign(
            position_command=lambda frame: 1.1 * frame["position"], **columns
        )
        for run in range(runs)
    ]
    return pd.concat(frames, ignore_index=True)


@pytest.mark.parametrize("sliding", [False, True])
@pytest.mark.parametrize("driven", ["position_command", "effort"])
def test_cleaning_derives_it_run_by_run_and_says_so(driven, sliding):
    frame = told().rename(columns={"position_command": driven})
    cleaned, _ = clean_recording(recording_from_frame(frame, "joint", sliding=sliding))
    assert cleaned.derived == ("velocity",)
    assert list(cleaned.units) == ["position", "velocity", driven]
    assert cleaned.units["velocity"] == ("m/s" if sliding else "rad/s")
    expected = 2.0 * np.cos(2.0 * cleaned.frame["t"] + cleaned.frame["run"].str[1:].astype(float))
    np.testing.assert_allclose(cleaned.frame["velocity"], expected, atol=1e-4)
    assert any("No velocity was recorded" in warning for warning in cleaned.warnings)


def test_what_was_derived_is_known_when_it_is_read_again_and_never_derived_twice(tmp_path):
    cleaned, _ = clean_recording(recording_from_frame(told(), "joint"))
    write_recording(cleaned, tmp_path / "a.parquet")
    again = read_recording(tmp_path / "a.parquet")
    assert again.derived == ("velocity",)
    assert again.warnings == cleaned.warnings
    once_more, _ = clean_recording(again)
    pd.testing.assert_frame_equal(once_more.frame, cleaned.frame)
    assert once_more.warnings == cleaned.warnings


def test_a_velocity_that_was_recorded_is_needed_and_kept():
    frame = told().assign(velocity=lambda each: 2.0 * np.cos(2.0 * each["t"]))
    frame.loc[frame["run"] == "r1", "velocity"] = np.nan
    recording = recording_from_frame(frame, "joint")
    assert any("'r1' has no values in velocity" in warning for warning in recording.warnings)
    cleaned, _ = clean_recording(recording)
    assert (cleaned.derived, cleaned.runs) == ((), ["r0"])


def test_a_servo_that_holds_its_zero_is_not_idle():
    frame = told(velocity=0.0).assign(position=0.05, position_command=0.0)
    cleaned, _ = clean_recording(
        Recording(frame, "joint", {"position": "rad", "velocity": "rad/s", "position_command": "rad"})
    )
    assert len(cleaned.frame) == len(frame)
