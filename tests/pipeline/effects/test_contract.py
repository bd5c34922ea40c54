"""What every effect of the catalogue promises to the simulator and to the diagnosis, tested on each of them."""

from itertools import pairwise

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.effects import ActuatorEffect, WrenchEffect
from simgap.simulation import Simulator, rollout
from simgap.simulation.motion import motion_of
from tests.pipeline.effects.responses import (
    TIME_STEP,
    actuated,
    assert_same,
    constants,
    response,
    sample_by_sample,
    sides_of,
    simulator_with,
    smooth_flight,
    smooth_swing,
    telling_values,
    with_hidden,
)
from tests.pipeline.platforms.machines import EVERY_EFFECT, MACHINES, identity, signals_for

EFFECT = pytest.mark.parametrize("effect", EVERY_EFFECT, ids=identity)
WRENCH = pytest.mark.parametrize(
    "effect", [effect for effect in EVERY_EFFECT if isinstance(effect, WrenchEffect)], ids=identity
)
# What looks at the samples on both sides in a recording, or takes a sample for the interval around it, can only look
# back in a simulation.
DIFFERENTIATING = ("rotor_inertia_torque", "slung_payload", "flexible_coupling")
ACTUATOR = pytest.mark.parametrize(
    "effect", [effect for effect in EVERY_EFFECT if isinstance(effect, ActuatorEffect)], ids=identity
)
LINEAR = pytest.mark.parametrize(
    "effect",
    [effect for effect in EVERY_EFFECT if isinstance(effect, WrenchEffect) and effect.linear],
    ids=identity,
)
BLOCKS = (3, 60)
COMMANDS = {
    "quadrotor": ("rotor_speed", "motor_command", "battery_voltage"),
    "swerve": ("drive_voltage", "steer_voltage", "battery_voltage"),
    "joint": ("voltage", "battery_voltage", "temperature"),
}


@EFFECT
def test_at_neutral_strength_the_balance_is_the_nominal_one(effect):
    signals = signals_for(effect, BLOCKS, seed=1)
    expected = sides_of(Simulator(MACHINES[effect.kind]), signals)
    assert_same(response(effect, effect.neutral(), signals), expected)


@EFFECT
def test_at_neutral_strength_a_rollout_is_the_nominal_one(effect):
    signals = signals_for(effect, (2, 5), seed=2)
    initial = motion_of(MACHINES[effect.kind]).pack({name: series[:, 0] for name, series in signals.items()})
    commands = {name: signals[name] for name in COMMANDS[effect.kind] if name in signals}
    expected = rollout(Simulator(MACHINES[effect.kind]), initial, commands, TIME_STEP)
    found = rollout(simulator_with(effect, effect.neutral()), initial, commands, TIME_STEP)
    torch.testing.assert_close(found, expected, rtol=1e-12, atol=1e-12)


@EFFECT
def test_at_a_telling_strength_the_balance_changes(effect):
    signals = signals_for(effect, BLOCKS, seed=3)
    nominal = response(effect, effect.neutral(), signals)
    changes = [response(effect, values, signals) for values in telling_values(effect)]
    assert any(not torch.equal(change[name], nominal[name]) for change in changes for name in nominal)


@EFFECT
def test_single_and_double_precision_agree(effect):
    signals = signals_for(effect, BLOCKS, seed=4)
    single = {name: series.float() for name, series in signals.items()}
    double = {name: series.double() for name, series in single.items()}
    for values in telling_values(effect):
        found = response(effect, values, single)
        assert {value.dtype for value in found.values()} == {torch.float32}
        expected = response(effect, values, double)
        assert {value.dtype for value in expected.values()} == {torch.float64}
        assert_same({name: value.double() for name, value in found.items()}, expected, rtol=2e-4)


@EFFECT
def test_blocks_do_not_know_of_each_other(effect):
    signals = signals_for(effect, BLOCKS, seed=5)
    whole = response(effect, effect.defaults(), signals)
    for block in range(BLOCKS[0]):
        alone = response(
            effect, effect.defaults(), {name: series[block : block + 1] for name, series in signals.items()}
        )
        assert_same(alone, {name: value[block : block + 1] for name, value in whole.items()})


@WRENCH
@pytest.mark.parametrize("shape", [(), (6,), (2, 6), (2, 1, 3)])
def test_the_leading_dimensions_of_a_wrench_are_free(effect, shape):
    signals = actuated(effect.kind, signals_for(effect, (12,), seed=6))
    signals = with_hidden(effect, signals, effect.defaults())
    flat = effect.wrench(signals, effect.defaults(), constants(effect.kind))
    count = torch.Size(shape).numel()
    shaped = {name: series[:count].reshape((*shape, *series.shape[1:])) for name, series in signals.items()}
    for name, value in effect.wrench(shaped, effect.defaults(), constants(effect.kind)).items():
        assert value.shape == shape
        torch.testing.assert_close(value.reshape(-1), flat[name][:count], rtol=1e-12, atol=1e-12)


@ACTUATOR
@pytest.mark.parametrize("shape", [(), (6,), (2, 6)])
def test_the_leading_dimensions_of_an_actuator_are_free(effect, shape):
    signals = actuated(effect.kind, signals_for(effect, shape, seed=7))
    changed, _ = effect.actuate(signals, effect.defaults(), constants(effect.kind), None, TIME_STEP)
    assert changed
    for name, value in changed.items():
        assert value.shape[: len(shape)] == shape
        assert name not in signals or value.shape == signals[name].shape


@WRENCH
def test_a_wrench_acts_on_channels_of_the_group_that_the_effect_names(effect):
    groups = {channel.name: channel.group for channel in Simulator(MACHINES[effect.kind]).mechanism.channels}
    signals = actuated(effect.kind, signals_for(effect, (4,), seed=8))
    signals = with_hidden(effect, signals, effect.defaults())
    added = effect.wrench(signals, effect.defaults(), constants(effect.kind))
    assert added.keys() <= groups.keys()
    found = {groups[name] for name in added}
    group = (
        "drive" if effect.acts_on == "chassis" else effect.acts_on
    )  # the equations of a chassis are its drive's
    assert group in found or (effect.acts_on == "actuator" and added)


@WRENCH
def test_an_effect_needs_no_more_signals_than_it_says(effect):
    always = {
        "quadrotor": {"position", "attitude", "velocity", "body_rate"},
        "swerve": {"drive_voltage", "steer_voltage", "drive_velocity", "steer_velocity", "steer_angle"}
        | {"chassis_velocity", "drive_torque", "steer_torque"},
        "joint": {"position", "velocity"},
    }[effect.kind]
    signals = actuated(effect.kind, signals_for(effect, (4,), seed=9))
    fewer = {name: series for name, series in signals.items() if name in always | set(effect.needs)}
    fewer = with_hidden(effect, fewer, effect.defaults())
    effect.wrench(fewer, effect.defaults(), constants(effect.kind))


@EFFECT
@settings(max_examples=15)
@given(seed=st.integers(0, 10**6), size=st.sampled_from([0.0, 1e-9, 1e-3, 1.0, 30.0]))
def test_answers_and_slopes_are_finite_from_standstill_to_any_speed(effect, seed, size):
    signals = signals_for(effect, (2, 12), seed)
    scaled = {
        name: series if name == "attitude" else (series * size).requires_grad_()
        for name, series in signals.items()
    }
    values = {
        name: torch.tensor(value, dtype=torch.float64, requires_grad=True)
        for name, value in effect.defaults().items()
    }
    found = response(effect, values, scaled)
    for value in found.values():
        assert torch.isfinite(value).all()
    leaves = [*values.values(), *(series for series in scaled.values() if series.requires_grad)]
    total = torch.stack([value.sum() for value in found.values()]).sum()
    for slope in torch.autograd.grad(total, leaves, allow_unused=True):
        assert slope is None or torch.isfinite(slope).all()


@EFFECT
def test_slopes_in_the_parameters_are_finite_differences(effect):
    signals = signals_for(effect, BLOCKS, seed=10)
    random = torch.Generator().manual_seed(0)
    weights: dict[str, torch.Tensor] = {}

    def weighed(values: dict) -> torch.Tensor:
        total = torch.zeros((), dtype=torch.float64)
        for name, value in response(effect, values, signals).items():
            if name not in weights:
                scale = value.detach().abs().max().clamp_min(1e-12)
                weights[name] = torch.rand(value.shape, generator=random, dtype=torch.float64) / scale
            total = total + (weights[name] * value).sum()
        return total

    slopes = []
    for start in telling_values(effect):
        values = {
            name: torch.tensor(value, dtype=torch.float64, requires_grad=True)
            for name, value in start.items()
        }
        gradient = torch.autograd.grad(weighed(values), list(values.values()))
        for (name, value), slope in zip(start.items(), gradient, strict=True):
            size = abs(value) or 1.0
            change = max(
                1e-7 * size, 3e-8
            )  # small, since a limit or a delay has kinks, and not lost in rounding
            above, below = (weighed(start | {name: value + sign * change}) for sign in (1.0, -1.0))
            difference = (above - below) / (2.0 * change)
            # Rounding of sums of about 100 leaves 1e-14 of them over so small a change.
            torch.testing.assert_close(slope, difference, rtol=1e-5, atol=5e-6 / size)
            slopes.append((name, float(slope)))
    assert {name for name, slope in slopes if slope != 0.0} == {
        parameter.name for parameter in effect.parameters
    }


@LINEAR
@given(seed=st.integers(0, 10**6), first=st.floats(-2.0, 2.0), second=st.floats(-2.0, 2.0))
@settings(max_examples=10)
def test_a_linear_effect_is_the_sum_of_its_regressors(effect, seed, first, second):
    signals = actuated(effect.kind, signals_for(effect, (7,), seed))
    numbers = constants(effect.kind)
    values = {
        parameter.name: (first if index % 2 == 0 else second) * parameter.default
        for index, parameter in enumerate(effect.parameters)
    }
    signals = with_hidden(effect, signals, values)
    regressors = effect.regressors(signals, numbers)
    assert len(regressors) == len(effect.parameters)
    total: dict[str, torch.Tensor] = {}
    for value, regressor in zip(values.values(), regressors, strict=True):
        for name, column in regressor.items():
            total[name] = total.get(name, 0.0) + value * column
    assert_same(effect.wrench(signals, values, numbers), total, rtol=1e-9)


@pytest.mark.parametrize(
    "effect",
    [e for e in EVERY_EFFECT if isinstance(e, ActuatorEffect) and e.name not in DIFFERENTIATING],
    ids=identity,
)
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_sample_by_sample_is_the_same_as_the_block_at_once(effect, dtype):
    signals = actuated(effect.kind, signals_for(effect, (3, 90), seed=11, dtype=dtype))
    tolerance = 1e-4 if dtype == torch.float32 else 1e-10
    for values in telling_values(effect):
        at_once = effect.along_time(signals, values, constants(effect.kind), TIME_STEP)
        scanned = sample_by_sample(effect, signals, values, TIME_STEP)
        for name, value in scanned.items():
            torch.testing.assert_close(value, at_once[name], rtol=tolerance, atol=tolerance)
        new = {n for n in at_once if n not in signals or not torch.equal(at_once[n], signals[n])}
        assert new <= scanned.keys()


@pytest.mark.parametrize("effect", [e for e in EVERY_EFFECT if e.name in DIFFERENTIATING], ids=identity)
def test_sample_by_sample_tends_to_the_block_at_once_as_the_step_shrinks(effect):
    """Looking back is late by half a step, so half the step halves the difference."""
    errors = []
    for samples in (100, 200, 400):
        signals = (smooth_flight if effect.kind == "quadrotor" else smooth_swing)(samples, duration=1.0)
        at_once = effect.along_time(signals, effect.defaults(), constants(effect.kind), 1.0 / samples)
        scanned = sample_by_sample(effect, signals, effect.defaults(), 1.0 / samples)
        settled = slice(samples // 10, -1)
        errors.append(
            max(float((s - at_once[n])[:, settled].abs().max() / s.abs().max()) for n, s in scanned.items())
        )
    assert errors[0] < 0.2
    for coarse, fine in pairwise(errors):
        assert 0.4 < fine / coarse < 0.6
