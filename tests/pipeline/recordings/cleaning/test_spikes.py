import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.recordings.cleaning.spikes import erase_spikes, find_spikes

STEP = 0.01
TIME = np.arange(600) * STEP


def noisy(signal, size=0.01, seed=0):
    return signal + size * np.random.default_rng(seed).standard_normal(len(signal))


@given(
    place=st.integers(20, 570),
    width=st.integers(1, 3),
    height=st.floats(1.5, 1e4),
    sign=st.sampled_from([-1, 1]),
)
def test_a_spike_of_up_to_three_samples_is_found_and_nothing_else(place, width, height, sign):
    values = noisy(np.sin(2 * TIME))
    values[place : place + width] += sign * height
    found = np.flatnonzero(find_spikes(values, TIME, least=1.0))
    assert found.tolist() == list(range(place, place + width))


@given(seed=st.integers(0, 2**16))
def test_noise_has_no_spikes(seed):
    assert not find_spikes(noisy(np.sin(2 * TIME), 0.05, seed), TIME).any()


@pytest.mark.parametrize("kind", ["step", "pulse of four samples", "decay", "burst", "ramp"])
def test_true_transients_are_left(kind):
    values = noisy(np.zeros(600), 1e-3)
    values[300:] += {
        "step": np.ones(300),
        "pulse of four samples": np.where(np.arange(300) < 4, 1.0, 0.0),
        "decay": np.exp(-TIME[:300] / 0.03),
        "burst": np.sin(2 * np.pi * 20 * TIME[:300]) * (TIME[:300] < 0.1),
        "ramp": np.minimum(TIME[:300] * 20, 1.0),
    }[kind]
    assert not find_spikes(values, TIME).any()


def test_a_quantised_signal_that_flickers_by_one_quantum_is_left():
    values = np.round(noisy(np.zeros(600), 0.2))
    assert set(np.unique(values)) <= {-1.0, 0.0, 1.0}
    assert not find_spikes(values, TIME).any()


def test_a_pulse_of_speed_is_true_where_the_position_moved(joint, as_run):
    """A stick-slip at a coarse rate is one sample of speed; the position tells it from a wrong reading."""
    frame = joint()
    frame[["position", "velocity"]] = np.random.default_rng(0).normal(0, 1e-5, (len(frame), 2))
    frame.loc[200, "velocity"] = 2.0
    frame.loc[400, "velocity"] = 2.0
    frame.loc[400:, "position"] += 2.0 * STEP
    run = as_run(frame, "joint")
    erase_spikes(run)
    assert np.flatnonzero(np.isnan(run.channel("velocity")[:, 0])).tolist() == [200]


def test_inputs_may_jump(joint, flight, as_run):
    frame = joint()
    frame["voltage"] = 0.0
    frame.loc[[100, 300], "voltage"] = 12.0
    run = as_run(frame, "joint")
    erase_spikes(run)
    assert not run.changes


def test_shocks_are_true_and_a_rotor_speed_of_ten_times_the_usual_is_not(flight, as_run):
    frame = flight()
    frame.loc[500, "specific_force_z"] = 60.0
    frame.loc[500, "body_rate_x"] = 20.0
    frame.loc[700, "motor_speed_2"] = 33036.0
    run = as_run(frame, "quadrotor")
    erase_spikes(run)
    assert [(change["column"], change["samples"]) for change in run.changes] == [("motor_speed_2", 1)]


def test_a_jump_of_one_component_erases_the_whole_attitude(flight, as_run):
    frame = flight()
    frame.loc[500, "attitude_x"] += 0.5
    run = as_run(frame, "quadrotor")
    erase_spikes(run)
    assert {change["column"] for change in run.changes} == {f"attitude_{axis}" for axis in "wxyz"}
    assert np.isnan(run.channel("attitude_w")[500, 0])
