import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from simgap.recordings.cleaning.channels import ATTITUDE
from simgap.recordings.cleaning.quaternions import mend_quaternions, slerp


def test_norms_are_mended_and_signs_made_continuous(flight, as_run):
    frame = flight()
    true = frame[ATTITUDE].to_numpy(copy=True)
    frame.loc[100:199, ATTITUDE] *= 1.02
    frame.loc[300:399, ATTITUDE] *= -1.0
    run = as_run(frame, "quadrotor")
    mend_quaternions(run)
    np.testing.assert_allclose(run.channel(*ATTITUDE), true, atol=1e-12)
    assert {change["reason"]: change["samples"] for change in run.changes} == {
        "normalised": 100,
        "sign made continuous": 100,
    }


def test_unit_quaternions_are_left_bit_for_bit(flight, as_run):
    frame = flight()
    run = as_run(frame, "quadrotor")
    mend_quaternions(run)
    assert (run.channel(*ATTITUDE) == frame[ATTITUDE].to_numpy()).all()
    assert not run.changes


def test_signs_are_continuous_across_missing_samples(flight, as_run):
    frame = flight()
    frame.loc[100:105, ATTITUDE] = np.nan
    frame.loc[106:, ATTITUDE] *= -1.0
    run = as_run(frame, "quadrotor")
    mend_quaternions(run)
    assert (run.channel("attitude_w")[106:] > 0).all()


def test_an_estimate_that_is_no_rotation_is_erased(flight, as_run):
    frame = flight()
    for axis in "wxyz":
        frame[f"estimate_attitude_{axis}"] = frame[f"attitude_{axis}"]
    frame.loc[50:59, "estimate_attitude_w"] = 2.7
    run = as_run(frame, "quadrotor")
    mend_quaternions(run)
    assert np.isnan(run.channel("estimate_attitude_x")[50:60]).all()
    assert not np.isnan(run.channel(*ATTITUDE)).any()


vectors = st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3)


@given(start=vectors, way=vectors, share=st.floats(0.0, 1.0), flip=st.booleans())
def test_slerp_turns_at_constant_rate_about_one_axis(start, way, share, flip):
    first, turn = Rotation.from_rotvec(start), Rotation.from_rotvec(np.array(way) / 2)
    last = (first * turn).as_quat(scalar_first=True)
    got = slerp(first.as_quat(scalar_first=True)[None], (-last if flip else last)[None], np.array([share]))
    expected = first * Rotation.from_rotvec(share * np.array(way) / 2)
    assert np.linalg.norm(got) == pytest.approx(1.0)
    assert (Rotation.from_quat(got[0], scalar_first=True) * expected.inv()).magnitude() < 1e-6
