"""Which effects of a hypothesis are worth a name."""

import functools

import pytest

from simgap.effects import effect_by_key
from simgap.equations.fit import Fit, fit
from simgap.gap.hypothesis import Hypothesis, weigh
from simgap.gap.reading import Reading, readings_of
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect
from tests.pipeline.gap.recordings import TIME_STEP, Plant, joint_recording, joint_simulator


@functools.cache
def reading() -> Reading:
    return readings_of(joint_recording(Plant()), joint_simulator(), Gap())[0]


def timed(**samples: float) -> Hypothesis:
    """Return a hypothesis whose effects delay by so many samples."""
    parameters = {"command_delay": "delay", "motor_lag": "time_constant"}
    effects = [
        FittedEffect(effect_by_key("joint", name), {parameters[name]: count * TIME_STEP})
        for name, count in samples.items()
    ]
    nominal = fit(reading().nominal, reading().problem)
    simulator = reading().nominal.with_effects(tuple(effects))
    residual = reading().problem.residual(simulator)
    jacobian = residual.new_zeros((*residual.shape, len(effects)))
    covariance = residual.new_zeros(len(effects), len(effects))
    return weigh(Fit(simulator, residual, jacobian, nominal.scale, covariance), reading())


@pytest.mark.parametrize("name", ["command_delay", "motor_lag"])
def test_less_than_a_sample_of_a_measured_command_is_no_delay(name):
    assert timed(**{name: 0.7}).names == frozenset()
    assert timed(**{name: 0.9}).names == {name}


def test_two_short_times_that_make_a_long_one_are_both_named():
    assert timed(command_delay=0.35, motor_lag=0.35).names == frozenset()
    assert timed(command_delay=0.7, motor_lag=0.7).names == {"command_delay", "motor_lag"}


def test_a_short_time_beside_a_long_one_stays_without_a_name():
    assert timed(command_delay=0.4, motor_lag=3.0).names == {"motor_lag"}
