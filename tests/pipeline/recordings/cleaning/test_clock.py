import numpy as np
import pytest

from simgap.recordings.cleaning.clock import compare_clocks, estimate_clock_offset

LARGEST = 0.1


@pytest.mark.parametrize("offset", [-0.0217, -0.004, 0.0, 0.0035, 0.0128, 0.0333])
def test_a_known_offset_is_found_within_a_tenth_of_a_sample(flight, as_run, offset):
    run = as_run(flight(seconds=20.0, offset=offset, seed=3), "quadrotor")
    assert estimate_clock_offset(run, LARGEST) == pytest.approx(offset, abs=0.001)


def test_each_sensor_has_its_own_clock(flight, as_run):
    frame = flight(seconds=20.0, offset=0.012)
    frame["specific_force_z"] = flight(seconds=20.0, offset=-0.007)["specific_force_z"]
    run = as_run(frame, "quadrotor")
    assert estimate_clock_offset(run, LARGEST) == pytest.approx(0.012, abs=0.001)
    seconds = {change["column"]: change["seconds"] for change in run.changes}
    assert seconds["specific_force_z"] == pytest.approx(-0.007, abs=0.001)


def test_the_standard_error_is_that_of_repeated_flights():
    """Errors over their own standard error scatter by about one."""
    random = np.random.default_rng(0)
    time_step, count, true = 0.01, 1500, 0.0123
    frequency = np.fft.rfftfreq(2 * count, time_step)
    ratios = []
    for _ in range(40):
        white = np.fft.rfft(random.standard_normal((2 * count, 2)), axis=0)
        white[(frequency < 1) | (frequency > 15)] = 0
        inputs = np.fft.irfft(white, axis=0)[:count]
        late = np.fft.irfft(white * np.exp(-2j * np.pi * frequency * true)[:, None], axis=0)[:count]
        outputs = late @ np.array([[1.0, 0.5], [-0.3, 1.0]]) + 0.3 * random.standard_normal((count, 2))
        found = compare_clocks([(inputs, outputs)], time_step, LARGEST, 20)
        ratios.append((found.seconds - true) / found.error)
    assert 0.7 < np.std(ratios) < 1.4
    assert abs(np.mean(ratios)) < 0.5


def test_motors_that_explain_nothing_tell_no_clock(flight, as_run):
    frame = flight(seconds=20.0)
    random = np.random.default_rng(5)
    for column in ("body_rate_x", "body_rate_y", "specific_force_z"):
        frame[column] = random.standard_normal(len(frame))
    run = as_run(frame, "quadrotor")
    assert estimate_clock_offset(run, LARGEST) is None
    assert {change["reason"] for change in run.changes} == {"clock offset could not be estimated"}


def test_an_offset_beyond_the_search_is_not_believed(flight, as_run):
    run = as_run(flight(seconds=20.0, offset=0.06), "quadrotor")
    assert estimate_clock_offset(run, 0.03) is None


def test_with_commands_alone_the_lag_of_the_motors_is_not_taken_for_an_offset(flight, as_run):
    frame = flight(seconds=20.0, offset=0.03)
    names = {f"motor_speed_{rotor}": f"motor_command_{rotor}" for rotor in "1234"}
    frame = frame.rename(columns=names)
    frame[list(names.values())] /= 3000.0
    run = as_run(frame, "quadrotor")
    assert estimate_clock_offset(run, LARGEST) is None
    assert any("lag of the motors included" in change["reason"] for change in run.changes)


def test_constant_motors_and_other_kinds_have_nothing_to_compare(flight, joint, as_run):
    frame = flight()
    frame[[f"motor_speed_{rotor}" for rotor in "1234"]] = 1800.0
    assert estimate_clock_offset(as_run(frame, "quadrotor"), LARGEST) is None
    assert estimate_clock_offset(as_run(joint(), "joint"), LARGEST) is None
    assert estimate_clock_offset(as_run(flight(seconds=2.0), "quadrotor"), LARGEST) is None
