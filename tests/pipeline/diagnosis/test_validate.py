from dataclasses import replace

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.diagnosis.diagnose import diagnose
from simgap.diagnosis.horizon import horizon_errors
from simgap.diagnosis.validate import Validation, gap_closed, validate
from simgap.effects import effect_by_key
from simgap.equations.residuals import channels_on
from simgap.equations.row_noise import noise_of_rows
from simgap.errors import InputError
from simgap.gap.settings import Gap
from simgap.simulation import FittedEffect
from tests.pipeline.gap.problems import FEW, diagnosed, problem_of, quick
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

pytestmark = pytest.mark.slow

errors = st.floats(1e-6, 1e6)


@given(errors, errors, errors)
def test_the_gap_closed_is_the_contracts_share(before, after, noise):
    closed = gap_closed(before, after, noise)
    assert closed <= 1.0
    if before <= noise:
        assert closed == 0.0
    elif after >= noise:
        assert closed == pytest.approx((before - after) / (before - noise), rel=1e-9, abs=1e-12)


@given(errors, st.floats(1.01, 10.0))
def test_the_ends_of_the_gap(noise, factor):
    before = factor * noise
    assert gap_closed(before, before, noise) == 0.0
    assert gap_closed(before, noise, noise) == pytest.approx(1.0)
    assert gap_closed(before, 0.5 * noise, noise) == 1.0
    assert gap_closed(before, 2.0 * before, noise) < 0.0


def test_held_out_runs_never_enter_the_fit():
    """Other data in them change the validation alone: names, values and probabilities stay bit for bit."""
    recording = joint_recording(Plant(friction=0.3))
    frame = recording.frame.copy()
    held = frame["run"].map(recording.split) == "holdout"
    frame.loc[held, "velocity"] *= 1.5
    frame.loc[held, "position"] *= 1.5
    found, other = (quick(r, joint_simulator(), FEW) for r in (recording, replace(recording, frame=frame)))
    assert found.simulator == other.simulator
    assert found.probabilities == other.probabilities
    assert found.naming.posterior.weights == other.naming.posterior.weights
    assert found.mismatches == other.mismatches
    assert found.validation.held_out_runs == other.validation.held_out_runs == ("run_4", "run_5")
    assert found.validation.after != other.validation.after


def test_what_only_held_out_runs_show_is_the_first_warning_and_no_verdict():
    found = diagnosed(Plant(viscous=(0.0, 0.0, 0.0, 0.0, 0.05, 0.05)), effects=FEW)
    assert (found.verdict, found.naming.named) == ("none", ())
    assert found.warnings[0].startswith("held-out runs refute the answer in torque: their error energy is")
    assert found.warnings[0].endswith("record more runs like them")
    assert not any("held-out runs refute" in warning for warning in diagnosed(Plant(), effects=FEW).warnings)


def test_names_that_help_no_held_out_run_are_doubted():
    found = diagnosed(Plant(friction=(0.3, 0.3, 0.3, 0.3, 0.0, 0.0)), effects=FEW)
    assert found.naming.named
    assert found.validation.gap_closed <= 0.0
    assert "do not rely on them" in found.warnings[0]
    right = diagnosed(Plant(friction=0.3), effects=FEW)
    assert not any("do not rely on them" in warning for warning in right.warnings)


@pytest.mark.parametrize(
    ("after", "noise", "closed", "disproves", "refutes"),
    [
        (0.5, 0.1, 0.5, False, False),
        (1.2, 0.1, -0.2, True, True),
        (1.2, 0.7, -0.7, True, False),
        (3.0, 0.1, None, False, False),
    ],
)
def test_runs_that_were_held_out_speak_against_names(after, noise, closed, disproves, refutes):
    validation = Validation("", ("run",), 1.0, after, noise, closed, None, torch.ones(1, 3), None)
    assert (validation.disproves, validation.refutes) == (disproves, refutes)


@pytest.mark.parametrize(
    "plant",
    [Plant(friction=0.3), Plant(current_limit=5.0), Plant(friction=0.3, other=lambda q, v: -0.02 * q)],
)
def test_the_interval_contains_the_estimate(plant):
    validation = diagnosed(plant, effects=FEW).validation
    assert validation.interval is not None
    low, high = validation.interval
    assert low <= validation.gap_closed <= high <= 1.0
    assert validation.after < validation.before


@pytest.mark.parametrize(("held", "known"), [((5,), False), ((4, 5), True), ((1, 2, 3, 4, 5), True)])
def test_one_held_out_run_gives_no_interval(held, known):
    """Stretches of one run say nothing about another run."""
    nominal = joint_simulator()
    friction = joint_simulator(FittedEffect(effect_by_key("joint", "coulomb_friction"), {"level": 0.3}))
    problem = problem_of(joint_recording(Plant(friction=0.3)), nominal)
    blocks = problem.blocks.of_runs([f"run_{run}" for run in held])
    validation = validate(
        nominal, friction, blocks, problem.functions, list(channels_on(nominal, blocks)), True, resamples=50
    )
    assert len(validation.held_out_runs) == len(held)
    assert validation.gap_closed > 0.8
    assert (validation.interval is not None) == known
    for error in horizon_errors(nominal, friction, blocks, 0.2, 50):
        for curve in (error.before, error.after):
            assert torch.isfinite(curve[:, 0]).all()
            assert bool(torch.isfinite(curve).all()) == known


def test_one_run_proves_nothing_and_says_so():
    found = diagnosed(Plant(friction=0.3), runs=1, effects=FEW)
    assert (found.validation.gap_closed, found.validation.interval, found.validation.held_out_runs) == (
        None,
        None,
        (),
    )
    assert any("held out" in warning for warning in found.warnings)
    assert found.validation.after < found.validation.before


def test_the_floor_is_where_a_right_simulator_lands():
    validation = diagnosed(Plant(), effects=FEW).validation
    assert validation.before == validation.after == pytest.approx(validation.noise_floor, rel=0.15)


def test_open_loop_predictions_fall_too():
    recording = joint_recording(Plant(friction=0.3))
    (position, velocity) = diagnose(recording, joint_simulator(), Gap(resamples=50, effects=[*FEW])).horizons
    assert (position.unit, velocity.unit) == ("rad", "rad/s")
    for error in (position, velocity):
        assert float(error.after[-1, 0]) < 0.2 * float(error.before[-1, 0])
        assert (error.before[:, 1] <= error.before[:, 0]).all()
        assert (error.before[:, 0] <= error.before[:, 2]).all()
        assert float(error.horizon[-1]) == pytest.approx(0.5)


def test_a_time_in_milliseconds_is_refused_in_one_line():
    recording = joint_recording(Plant(friction=0.3))
    frame = recording.frame.assign(t=1000.0 * recording.frame["t"])
    with pytest.raises(InputError, match="milliseconds instead of seconds") as caught:
        quick(replace(recording, frame=frame), joint_simulator())
    assert "\n" not in str(caught.value)


def test_a_simulator_whose_forces_jump_does_not_raise_the_floor():
    play = FittedEffect(effect_by_key("joint", "backlash"), {"gap": 0.05, "motor_inertia_share": 0.97})
    nominal, jumping = joint_simulator(), joint_simulator(play)
    problem = problem_of(joint_recording(Plant()), nominal)
    blocks, functions = problem.blocks, problem.functions
    quiet, loud = (noise_of_rows(each, blocks, functions) for each in (nominal, jumping))
    assert (loud > 2.0 * quiet).all()
    for pair in ((nominal, jumping), (jumping, nominal)):
        validation = validate(
            *pair, blocks, functions, list(channels_on(nominal, blocks)), True, resamples=10
        )
        assert validation.noise_floor == pytest.approx(float(quiet))
