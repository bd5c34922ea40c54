"""Numbers of a platform that are further off than a fit looks for."""

from dataclasses import replace

import pytest

from simgap.effects import effect_by_key
from simgap.gap.gains import IdentifiedGain
from simgap.gap.limits import at_limits, excessive_thrust, gains_said
from simgap.gap.prepare import prepare
from simgap.gap.settings import Gap
from simgap.platforms import Controller, Joint
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import flown, racer


def with_ratio(ratio: float, known: bool = False) -> Simulator:
    error = effect_by_key("quadrotor", "inertia_error")
    lag = FittedEffect(effect_by_key("quadrotor", "motor_lag"), {"time_constant": 0.5, "down_ratio": 5.0})
    return Simulator(racer(), (lag, FittedEffect(error, {"ratio": ratio}, known=known)))


@pytest.mark.parametrize("ratio", [10.0, 0.1])
def test_a_ratio_on_its_limit_is_said_with_what_to_do(ratio):
    (said,) = at_limits(with_ratio(ratio))
    assert "inertia_error" in said
    assert f"{ratio:.3g}" in said
    assert "multiply the number in the platform file" in said


def test_a_gain_on_its_limit_is_called_by_the_name_of_its_key():
    servo = Joint(inertia=0.02, controller=Controller(proportional=2.0))
    gain = FittedEffect(IdentifiedGain("derivative"), {"ratio": 100.0})
    (said,) = at_limits(Simulator(servo, (gain,)))
    assert said.startswith("controller.derivative: 100 times")


def test_of_identified_gains_those_are_numbers_that_the_recording_tells():
    """One is on its limit, of which `at_limits` speaks; one has an error as large as itself; one is known."""
    nominal = Simulator(Joint(inertia=0.02, controller=Controller(2.0, 0.1, None, 1.0, 0.1)))
    for std, told in ((0.4, True), (3.0, False)):
        found = Simulator(Joint(inertia=0.02, controller=Controller(2.5, 0.2, None, std, 0.01)))
        proportional, derivative = gains_said(found, nominal, [])
        assert ("identified as 2.5 ± 0.4 " in proportional) == told
        assert ("does not tell it: gains and friction look alike" in proportional) != told
        assert "identified as 0.2 ± 0.01 " in derivative
        assert gains_said(found, nominal, ["controller.derivative: 100 times"]) == [proportional]


def test_a_ratio_inside_is_not_nor_one_that_a_person_gave():
    assert at_limits(with_ratio(9.9)) == []
    assert at_limits(with_ratio(10.0, known=True)) == []


@pytest.mark.parametrize(("factor", "said"), [(1.0, False), (2.0, False), (5.0, True), (0.2, True)])
def test_a_thrust_far_from_the_platform_file_is_a_contradiction(factor, said):
    """Without velocity and attitude it would be named as four faulty rotors."""
    whole = flown((), seed=2, runs=2)
    lost = [c for c in whole.frame if str(c).startswith(("position", "attitude", "velocity", "motor_speed"))]
    recording = replace(whole, frame=whole.frame.drop(columns=lost))
    believed = replace(racer(), thrust_coefficient=factor * racer().thrust_coefficient)
    thrust = excessive_thrust(prepare(recording, Simulator(believed), Gap(), held=False))
    assert bool(thrust) == said
    for each in thrust:
        factor_to_take = float(each.remedy.split("thrust_coefficient by ")[1].split(",")[0])
        assert factor_to_take * factor == pytest.approx(1.0, abs=0.25)
