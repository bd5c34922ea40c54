from functools import cache

import numpy as np
import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.models.quadrotor_parameters import identify_quadrotor
from simgap.models.settings import SystemIdentification
from tests.pipeline.models.synthetic import QUADROTOR, flight, recording, with_noise

TRUTH = {
    "thrust_coefficient": QUADROTOR.thrust_coefficient,
    "inertia_xx": QUADROTOR.inertia[0],
    "inertia_yy": QUADROTOR.inertia[1],
    "torque_coefficient_over_inertia_zz": QUADROTOR.torque_coefficient / QUADROTOR.inertia[2],
}


@cache
def flights():
    return [flight(f"flight{seed}", seed) for seed in range(3)]


def identified(frames, **options):
    recorded = recording(pd.concat(frames, ignore_index=True), "quadrotor")
    return identify_quadrotor(recorded, QUADROTOR, recorded.runs, SystemIdentification(**options)).parameters


def test_a_flight_without_noise_gives_every_observable_parameter():
    found = identified(flights(), window=0.1)
    for name, value in TRUTH.items():
        assert found[name].value == pytest.approx(value, rel=0.01), name
        assert found[name].nominal == pytest.approx(value)


def test_what_motion_cannot_tell_has_no_value():
    found = identified(flights())
    for name in ("torque_coefficient", "inertia_zz"):
        assert found[name].value is None
        assert "not observable alone" in found[name].note


def test_standard_errors_cover_the_truth_under_noise():
    # 12 recordings, four parameters: nominally 95 % of 48 within two standard errors. A correct method falls to 80 %
    # or below in about one of 10⁴ draws of the seeds (binomial, if the four were independent).
    inside = []
    for seed in range(12):
        noisy = [with_noise(frame, 10 * seed + number) for number, frame in enumerate(flights())]
        found = identified(noisy, window=0.15, block_duration=1.0)
        inside += [abs(found[n].value - v) < 2 * found[n].standard_error for n, v in TRUTH.items()]
    assert np.mean(inside) > 0.8


def test_commands_stand_for_speeds_and_give_the_product():
    frames = []
    for frame in flights():
        renamed = frame.copy()
        for number in range(1, 5):
            speed = renamed.pop(f"motor_speed_{number}")
            renamed[f"motor_command_{number}"] = speed / QUADROTOR.motor_speed_max
        frames.append(renamed)
    found = identified(frames, window=0.1)
    product = found["thrust_coefficient_times_motor_speed_max_squared"]
    expected = QUADROTOR.thrust_coefficient * QUADROTOR.motor_speed_max**2
    assert product.value == pytest.approx(expected, rel=0.01)
    assert product.unit == "N"
    assert found["inertia_xx"].value == pytest.approx(QUADROTOR.inertia[0], rel=0.01)


def test_hovering_shows_thrust_but_no_inertia():
    time = np.arange(0.0, 6.0, 0.01)
    still = {name: np.zeros(len(time)) for name in flights()[0] if name not in ("run", "t", "segment")}
    hover = QUADROTOR.hover_rotor_speed
    still |= {f"motor_speed_{number}": np.full(len(time), hover) for number in range(1, 5)}
    frame = pd.DataFrame({"run": "hover", "t": time, "segment": 0} | still | {"attitude_w": 1.0})
    found = identified([frame])
    assert found["inertia_xx"].value is None
    assert "does not excite" in found["inertia_xx"].note


def test_an_estimate_that_depends_on_the_window_is_withheld():
    # A torque that the rotors answer late: over long windows their answer looks like its cause.
    found = identified([answering_late(frame, 30.0) for frame in flights()], least_explained=0.0)[
        "inertia_xx"
    ]
    assert found.value is None
    assert "from twice as long" in found.note


def test_an_equation_that_does_not_hold_gives_nothing():
    frames = []
    for number, frame in enumerate(flights()):
        rng = np.random.default_rng(number)
        unrelated = {f"motor_speed_{k}": 1000.0 + 300.0 * rng.random(len(frame)) for k in range(1, 5)}
        frames.append(frame.assign(**unrelated))
    found = identified(frames)
    assert all(found[name].value is None for name in TRUTH)
    assert "explain only" in found["thrust_coefficient"].note


def test_an_inertia_that_cannot_be_is_withheld():
    found = identified([answering_late(frame, 100.0) for frame in flights()], least_explained=0.0)[
        "inertia_xx"
    ]
    assert found.value is None
    assert "is not possible" in found.note


def answering_late(frame, gain):
    """Return a flight whose roll rotors also follow the mean roll rate of the last 0.4 s, to no effect."""
    spoilt = frame.copy()
    late = gain * frame["body_rate_x"].rolling(40, min_periods=1).mean()
    for number, sign in ((1, -1), (2, -1), (3, 1), (4, 1)):
        spoilt[f"motor_speed_{number}"] = frame[f"motor_speed_{number}"] + sign * late
    return spoilt


def test_segments_shorter_than_a_window_are_refused():
    with pytest.raises(InputError, match=r"sysid\.window"):
        identified([flights()[0].iloc[:10]])
