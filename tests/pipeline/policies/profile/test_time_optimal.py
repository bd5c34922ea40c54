import math

import numpy as np
import pytest

from simgap.errors import InputError
from simgap.policies.profile.reference import trapezoid
from simgap.policies.profile.time_optimal import time_optimal
from tests.pipeline.policies.profile.drives import bang_bang, uniform


@pytest.mark.parametrize("constants", [(0.4, 3.78, 1.06), (0.0, 2.68, 0.47), (1.0, 4.4, 0.7)])
@pytest.mark.parametrize("top", [math.inf, 2.0])
@pytest.mark.parametrize("distance", [0.3, 3.0])
def test_optimal_control_finds_the_exact_bang_bang_solution(constants, top, distance):
    found = time_optimal(uniform(*constants), distance, top)
    exact, peak = bang_bang(*constants, distance, top)
    assert exact - 1e-6 <= found.time[-1] <= 1.001 * exact
    assert found.position[-1] == pytest.approx(distance, abs=1e-5)
    assert found.velocity[-1] == pytest.approx(0.0, abs=1e-5)
    assert found.velocity.max() == pytest.approx(peak, rel=0.01)


def test_the_voltage_is_full_ahead_and_then_full_back():
    found = time_optimal(uniform(), 3.0)
    voltage = found.voltage[:, 0]
    assert (
        np.sum(np.abs(np.abs(voltage) - 12.0) > 1e-3) <= 2
    )  # the intervals in which it turns round, and the last
    assert np.sum(np.abs(np.diff(np.sign(voltage))) > 0) == 1


@pytest.mark.parametrize("top", [1.5, 3.0])
def test_where_grip_alone_limits_it_the_bound_is_the_trapezoid(top):
    found = time_optimal(uniform(acceleration_limit=2.0), 3.0, top)
    assert found.time[-1] == pytest.approx(trapezoid(3.0, top, 2.0).duration, rel=2e-3)


def test_more_intervals_come_nearer_to_the_bound():
    exact, _ = bang_bang(0.4, 3.78, 1.06, 3.0)
    excess = [time_optimal(uniform(), 3.0, intervals=count).time[-1] - exact for count in (20, 200)]
    assert 0.0 < excess[1] < 0.1 * excess[0]


def test_a_voltage_below_friction_is_refused():
    with pytest.raises(InputError, match="does not overcome friction"):
        time_optimal(uniform(static=13.0), 3.0)
