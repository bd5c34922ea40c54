"""What contradicts itself is found with its cause, and what is merely strange is left alone."""

import re
from dataclasses import replace

import numpy as np
import pytest

from simgap.consistency import contradictions
from simgap.recordings.contradiction import SUSPECTED
from simgap.recordings.recording import Recording
from tests.pipeline.consistency.corruption import CORRUPTIONS
from tests.pipeline.consistency.plants import SERVO, sample, servo
from tests.pipeline.consistency.table import alarms, show, tabulate, tabulate_rows

# Flights and drives are slow to record under type checks at every call.
KINDS = ["joint", *(pytest.param(kind, marks=pytest.mark.slow) for kind in ("swerve", "quadrotor"))]
EVERY = {"joint": 2, "swerve": 9, "quadrotor": 16}
"""Of so many corruptions a fast test tries one; tests/pipeline/consistency/table.py tries them all."""


def scaled(recording: Recording, factor: float, *columns: str) -> Recording:
    return replace(
        recording, frame=recording.frame.assign(**{name: factor * recording.frame[name] for name in columns})
    )


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_sample_of_every_corruption_is_caught_with_its_cause_first(kind, capsys):
    rows = tabulate(kind, sample(kind), limit=1, every=EVERY[kind])
    with capsys.disabled():
        print("\n" + show(rows))
    tried, caught, right = (
        sum(getattr(row, key) for row in rows.values()) for key in ("tried", "caught", "right")
    )
    assert tried >= 3
    assert caught == tried
    assert right == tried


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_faults_of_rows_are_mended_and_said_and_no_contradiction(kind, capsys):
    rows = tabulate_rows(kind, sample(kind), limit=1)
    with capsys.disabled():
        print("\n" + show(rows, "fault of rows: said, and nothing else"))
    assert sum(row.tried for row in rows.values()) >= 6
    assert all(row.right == row.tried for row in rows.values())


@pytest.mark.parametrize("kind", KINDS)
def test_good_recordings_raise_no_alarm(kind):
    count, false = alarms(sample(kind))
    assert count
    assert false == []


@pytest.mark.parametrize("kind", KINDS)
def test_without_a_platform_only_what_needs_none_is_checked(kind):
    one = sample(kind)[0]
    assert contradictions(one.recording, None) == []
    rate = {"joint": ["velocity"], "swerve": [f"steer_velocity_{m}" for m in "1234"]}.get(
        kind, [f"body_rate_{axis}" for axis in "xyz"]
    )
    sliding = one.recording.units.get("position") == "m" and kind == "joint"
    found = contradictions(scaled(one.recording, 1000.0 if sliding else 180.0 / np.pi, *rate), None)
    assert found[0].suspected == ("millimetres" if sliding else "degrees")


@pytest.mark.parametrize(
    "physics", [{"friction": 2.0}, {"viscous": 0.5}, {"scale": 1.44}, {"scale": 0.7}, {}]
)
def test_strange_physics_is_no_contradiction(physics):
    assert contradictions(servo(**physics), SERVO) == []


def test_a_duty_names_its_column_its_supply_and_the_line_that_mends_it():
    (found,) = contradictions(servo(scale=6.0), SERVO)
    assert (found.column, found.suspected, found.runs) == ("voltage", "duty", ("run0", "run1", "run2"))
    assert "a duty of a supply of some" in found.evidence
    supply = float(
        re.fullmatch(r"Say in the mapping: voltage: {from: voltage, scale: (.*)}\.", found.remedy)[1]
    )
    assert supply == pytest.approx(6.0, rel=0.3)  # friction takes its part of the voltage


def test_rotations_of_position_and_velocity_together_are_found():
    (found,) = contradictions(scaled(servo(), 0.5 / np.pi, "position", "velocity"), SERVO)
    assert (found.column, found.suspected) == ("position and velocity", "rotations")
    assert "position: {from: position, unit: rev}" in found.remedy
    assert "velocity: {from: velocity, unit: rev/s}" in found.remedy


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_sensor_that_counts_half_or_double_is_found(factor):
    (found,) = contradictions(scaled(servo(), factor, "velocity"), SERVO)
    assert (found.column, found.suspected) == ("velocity", "counts")


def test_two_faults_at_once_are_both_found():
    twice = scaled(scaled(servo(), 180.0 / np.pi, "position"), 30.0 / np.pi, "velocity")
    found = contradictions(twice, SERVO)
    assert {(each.column, each.suspected) for each in found} == {
        ("position", "degrees"),
        ("velocity", "turns_per_minute"),
    }


def test_only_the_runs_that_are_wrong_are_named():
    recording = servo()
    wrong = recording.frame["run"] == "run1"
    frame = recording.frame.assign(
        velocity=recording.frame["velocity"].where(~wrong, 57.29578 * recording.frame["velocity"])
    )
    (found,) = contradictions(replace(recording, frame=frame), SERVO)
    assert (found.suspected, found.runs) == ("degrees", ("run1",))


def test_a_rate_of_no_known_unit_is_still_a_contradiction():
    (found,) = contradictions(scaled(servo(), 20.0, "velocity"), None)
    assert (found.column, found.suspected) == ("velocity", "unit")


def test_every_cause_has_words():
    causes = {cause for kind in CORRUPTIONS.values() for corruption in kind for cause in corruption.causes}
    assert causes <= set(SUSPECTED)
