"""Numbers of a platform that are further off than a fit looks for."""

import pytest

from simgap.effects import effect_by_key
from simgap.gap.limits import at_limits
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import racer


def with_ratio(ratio: float, known: bool = False) -> Simulator:
    error = effect_by_key("quadrotor", "inertia_error")
    lag = FittedEffect(effect_by_key("quadrotor", "motor_lag"), {"time_constant": 0.5, "down_ratio": 5.0})
    return Simulator(racer(), (lag, FittedEffect(error, {"ratio": ratio}, known=known)))


@pytest.mark.parametrize("ratio", [3.0, 1 / 3])
def test_a_ratio_on_its_limit_is_said_with_what_to_do(ratio):
    (said,) = at_limits(with_ratio(ratio))
    assert "inertia_error" in said
    assert f"{ratio:.3g}" in said
    assert "multiply the number in the platform file" in said


def test_a_ratio_inside_is_not_nor_one_that_a_person_gave():
    assert at_limits(with_ratio(2.9)) == []
    assert at_limits(with_ratio(3.0, known=True)) == []
