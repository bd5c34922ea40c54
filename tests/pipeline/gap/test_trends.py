"""Machines that change slowly: what grows or fades is said, and gets no name of a law that stays."""

import functools
import math

import pytest

from simgap.diagnosis.diagnose import diagnose
from simgap.effects import effect_by_key
from simgap.equations.trend import trends_of
from simgap.gap.reading import readings_of
from simgap.gap.settings import Gap
from simgap.gap.trends import trending_reading
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

pytestmark = pytest.mark.slow

AMONG = ["coulomb_friction", "viscous_friction", "motor_constant_error", "inertia_error", "command_delay"]
RUNS = 8
GROWING = tuple(0.04 * run for run in range(RUNS))
FADING = GROWING[::-1]


@functools.cache
def found(friction, viscous=0.0):
    """Return the diagnosis of a joint whose dry friction is another one in each run."""
    return diagnose(
        joint_recording(Plant(friction=friction, viscous=viscous), runs=RUNS),
        joint_simulator(),
        Gap(effects=AMONG),
    )


@pytest.mark.parametrize(("friction", "how"), [(GROWING, "grows"), (FADING, "fades")])
def test_friction_that_changes_slowly_is_said_and_has_no_name(friction, how):
    diagnosis = found(friction)
    assert diagnosis.verdict == "unexplained"
    assert not diagnosis.naming.named
    assert any(
        f"something {how} through the recording and acts like coulomb friction" in w
        for w in diagnosis.warnings
    )


def test_the_simulator_has_what_acts_on_average():
    (fitted,) = found(GROWING).simulator.effects
    assert fitted.effect.key == "coulomb_friction"
    assert fitted.values["level"] == pytest.approx(math.fsum(GROWING[:-2]) / (RUNS - 2), rel=0.2)


def test_what_stays_is_named_beside_what_grows():
    diagnosis = found(GROWING, viscous=0.1)
    assert [named.effect.key for named in diagnosis.naming.named] == ["viscous_friction"]
    assert diagnosis.naming.named[0].probability > 0.9


@pytest.mark.parametrize("runs", [1, 3])
def test_the_shapes_of_a_trend_share_its_odds(runs):
    reading = readings_of(joint_recording(Plant(), runs=runs), joint_simulator(), Gap())[0]
    friction = effect_by_key("joint", "coulomb_friction")
    shapes = trends_of(friction, reading.prepared.recorded)
    total = sum(trending_reading(reading, shape).odds for shape in shapes)
    assert total == pytest.approx(0.1 * reading.odds)


def test_friction_that_stays_grows_nowhere():
    assert found((0.15,) * RUNS).naming.trend is None
