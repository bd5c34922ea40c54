"""When a vehicle flies; what is fast enough; attitudes without jumps."""

import numpy as np
import pytest

from simgap.logs.common_times import in_order
from simgap.logs.layouts.choices import Choice, choose
from simgap.logs.layouts.flights import Stretch, flights, stretches
from simgap.logs.layouts.rates import rated
from simgap.logs.log import Log, Signal, Span
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposed
from simgap.logs.quaternions import without_jumps

TIME = np.linspace(0.0, 20.0, 2001)
HEIGHT = Signal("height", TIME, np.clip(np.minimum(TIME - 4.0, 16.0 - TIME), 0.0, 3.0) + 100.0)
"""A climb from 4 s on, a landing at 16 s, with 1 m/s, on a hill of 100 m."""


def _log(**rates: float) -> Log:
    signals = {}
    for name, rate in rates.items():
        time = np.arange(0.0, 10.0, 1.0 / rate)
        signals[name] = Signal(name, time, np.sin(time))
    return Log("test", "log", signals)


def test_a_flight_is_what_is_clear_of_the_ground() -> None:
    (span,) = flights([Stretch(2.0, 18.0)], HEIGHT)
    assert (span.begin, span.end) == pytest.approx((4.3, 15.7), abs=0.02)


def test_a_log_that_begins_and_ends_in_the_air_is_all_flight() -> None:
    assert flights([Stretch(8.0, 12.0, False, False)], HEIGHT) == (Span("flight_1", 8.0, 12.0),)


def test_a_hop_and_a_detector_that_is_wrong_are_no_flights() -> None:
    assert flights([Stretch(3.0, 5.5, to_ground=False)], HEIGHT) == ()
    assert flights([Stretch(0.0, 3.9)], HEIGHT) == ()
    assert flights([Stretch(0.0, 20.0)], Signal("height", np.empty(0), np.empty(0))) == ()


def test_without_a_height_the_vehicle_is_believed() -> None:
    said = [Stretch(1.0, 5.0), Stretch(9.0, 10.0), Stretch(11.0, 19.0)]
    assert flights(said, None) == (Span("flight_1", 1.0, 5.0), Span("flight_2", 11.0, 19.0))


def test_stretches_of_a_state() -> None:
    times, flying = np.arange(6.0), np.array([True, False, True, True, False, True])
    assert stretches(times, flying, 7.5) == [
        Stretch(0.0, 1.0, False, True),
        Stretch(2.0, 4.0, True, True),
        Stretch(5.0, 7.5, True, False),
    ]


@pytest.mark.parametrize(("second", "taken"), [(150.0, "first"), (250.0, "second")])
def test_a_better_signal_is_taken_unless_another_is_much_faster(second: float, taken: str) -> None:
    log = _log(first=100.0, second=second)
    assert choose(log, [Choice([name], "") for name in ("absent", "first", "second")]).signals == [taken]


def _proposed(**signals: str) -> dict[str, Proposed]:
    return {column: Proposed(Source(signal), 1.0, "") for column, signal in signals.items()}


def test_slow_motors_or_rates_make_a_log_useless() -> None:
    log = _log(slow=10.0, fast=100.0)
    everything = {"position_x": "fast", "body_rate_x": "fast", "motor_command_1": "fast"}
    assert not rated(log, _proposed(**everything), "").refused
    for column in ("body_rate_x", "motor_command_1"):
        columns = _proposed(**(everything | {column: "slow"}))
        assert rated(log, columns, "").refused == {"slow": pytest.approx(10.0)}
        assert rated(log, columns, "").columns == columns


def test_what_else_is_slow_is_left_out_and_said() -> None:
    log = _log(slow=10.0, fast=100.0)
    columns = _proposed(position_x="slow", body_rate_x="fast", motor_command_1="slow", motor_speed_1="fast")
    found = rated(log, columns, "log it faster")
    assert set(found.columns) == {"body_rate_x", "motor_speed_1"}
    assert "log it faster" in found.missing["position_x"]
    assert found.notes == ("slow at 10 Hz is left out: too slow to show motors.",)


def test_an_attitude_that_changes_its_sign_is_one_turn() -> None:
    angle = np.linspace(0.0, 6.0, 61)
    parts = {
        f"attitude_{part}": Signal(part, angle, values * np.where((angle > 2) & (angle < 4), -1.0, 1.0))
        for part, values in zip(
            "wxyz", (np.cos(angle / 2), np.sin(angle / 2), 0 * angle, 0 * angle), strict=True
        )
    }
    turned = without_jumps(parts)
    np.testing.assert_allclose(turned["attitude_w"].values, np.cos(angle / 2))
    np.testing.assert_allclose(turned["attitude_x"].values, np.sin(angle / 2))


def test_of_samples_at_one_time_the_first_is_kept() -> None:
    signal = in_order(Signal("x", np.array([0.0, 2.0, 1.0, 2.0]), np.array([1.0, 2.0, 3.0, 4.0])))
    np.testing.assert_array_equal(signal.time, [0.0, 1.0, 2.0])
    np.testing.assert_array_equal(signal.values, [1.0, 3.0, 2.0])
