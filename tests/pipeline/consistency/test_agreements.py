"""What is compared: the lag at which two series agree, and rotors that are not alike."""

from dataclasses import replace

import pytest

from simgap.consistency import contradictions, size_doubts
from simgap.consistency.redundancy import LAGS, Agreement, at_best_lag
from simgap.consistency.rotors import rotor_laws
from simgap.consistency.samples import samples_of
from simgap.platforms import platform_from_config
from tests.pipeline.consistency.plants import SERVO, sample, servo


@pytest.mark.parametrize("best", LAGS)
def test_the_likeliest_lag_counts_also_where_both_sides_agree_without_one(best):
    found = at_best_lag(lambda lag: Agreement("", (), -float(abs(lag - best)), False, ""))
    assert found is not None
    assert found.support == 0.0


def test_where_nothing_moves_there_is_no_comparison():
    assert at_best_lag(lambda lag: None) is None


@pytest.mark.slow
def test_a_stronger_rotor_does_not_hide_what_the_others_tell_of_the_turning():
    one = sample("quadrotor")[0]
    speeds = {
        f"motor_speed_{rotor}": one.recording.frame[f"motor_speed_{rotor}"] * thrust**0.5
        for rotor, thrust in enumerate((1.3, 0.9, 0.9, 0.9), 1)
    }
    recording = replace(one.recording, frame=one.recording.frame.assign(**speeds))
    laws = list(rotor_laws(samples_of(recording), platform_from_config(one.platform), "motor_speed"))
    assert len(laws) == 4
    for law in laws:
        assert law is not None
        assert law.ratio == pytest.approx(1.0, abs=0.2), law.name  # 0.5 where rotors have to be alike


@pytest.mark.parametrize(
    "kind", ["joint", *(pytest.param(k, marks=pytest.mark.slow) for k in ("swerve", "quadrotor"))]
)
def test_no_size_of_a_good_recording_is_doubted(kind):
    assert [said for one in sample(kind) for said in size_doubts(one.recording)] == []


def test_a_rate_of_another_size_is_doubted_where_no_unit_explains_it():
    """A real arm has a velocity of 0.6 times the change of its position, and nobody knows why."""
    recording = servo()
    wrong = replace(recording, frame=recording.frame.assign(velocity=0.7 * recording.frame["velocity"]))
    assert contradictions(wrong, SERVO) == []
    (said,) = size_doubts(wrong)
    assert "'velocity' is 0.7 times as large as the rate of change of 'position'" in said
