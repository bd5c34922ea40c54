import pytest
import torch

from simgap.effects import effect_by_key, effects_of
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.motion import motion_of
from tests.pipeline.platforms.machines import JOINT, MACHINES, SWERVE, some_signals

COMMANDS = {
    "quadrotor": ("rotor_speed", "battery_voltage"),
    "swerve": ("drive_voltage", "steer_voltage", "battery_voltage"),
    "joint": ("voltage", "battery_voltage", "temperature"),
}
KINDS = pytest.mark.parametrize("kind", list(MACHINES))


def everything(kind: str) -> Simulator:
    effects = tuple(FittedEffect(effect, effect.defaults()) for effect in effects_of(kind))
    return Simulator(MACHINES[kind], effects)


def start(kind: str, batch: int, steps: int, seed: int, dtype: torch.dtype = torch.float64):
    signals = some_signals(kind, (batch, steps), seed, dtype)
    initial = motion_of(MACHINES[kind]).pack({name: series[:, 0] for name, series in signals.items()})
    return initial, {name: signals[name] for name in COMMANDS[kind]}


@KINDS
def test_the_error_falls_with_the_fourth_order_of_the_substeps(kind):
    smooth = tuple(
        FittedEffect(effect, effect.defaults())
        for effect in effects_of(kind)
        if effect.name == "viscous_friction"
    )
    simulator = Simulator(MACHINES[kind], smooth)
    initial, commands = start(kind, 4, 1, seed=1)
    first, second, exact = (rollout(simulator, initial, commands, 0.03, n)[:, -1] for n in (2, 4, 32))
    coarse, fine = (float((states - exact).norm()) for states in (first, second))
    assert coarse / fine == pytest.approx(16.0, rel=0.35)


@KINDS
def test_one_machine_alone_moves_as_in_a_crowd(kind):
    initial, commands = start(kind, 4, 4, seed=2)
    together = rollout(everything(kind), initial, commands, 0.01)
    for index in range(4):
        one = slice(index, index + 1)
        alone = rollout(everything(kind), initial[one], {name: s[one] for name, s in commands.items()}, 0.01)
        torch.testing.assert_close(alone, together[one], rtol=1e-12, atol=1e-12)


@KINDS
def test_single_precision_follows_double(kind):
    initial, commands = start(kind, 3, 8, seed=3)
    double = rollout(everything(kind), initial, commands, 0.005)
    single = rollout(everything(kind), initial.float(), {n: s.float() for n, s in commands.items()}, 0.005)
    assert single.dtype == torch.float32
    torch.testing.assert_close(single.double(), double, rtol=1e-3, atol=1e-3)


@pytest.mark.slow
@KINDS
def test_a_rollout_is_differentiable_in_start_commands_and_parameters(kind):
    initial, commands = start(kind, 1, 2, seed=4)
    effects = [
        effect for effect in effects_of(kind) if effect.name not in ("command_delay", "sensor_time_offset")
    ]
    names = [(effect, parameter.name) for effect in effects for parameter in effect.parameters]
    values = [torch.tensor(effect.defaults()[name], dtype=torch.float64) for effect, name in names]

    def last(strengths: torch.Tensor) -> torch.Tensor:
        """Return the end as a function of every number, each in proportion to its size."""
        chosen: dict = {effect: {} for effect in effects}
        for (effect, name), value, strength in zip(names, values, strengths, strict=False):
            chosen[effect][name] = value * strength
        simulator = Simulator(MACHINES[kind], tuple(FittedEffect(e, v) for e, v in chosen.items()))
        push, shake = strengths[-2], strengths[-1]
        return rollout(simulator, initial * push, {n: s * shake for n, s in commands.items()}, 0.01)[0, -1]

    ones = torch.ones(len(names) + 2, dtype=torch.float64)
    slopes = torch.autograd.functional.jacobian(last, ones)
    end = last(ones)
    for column in range(len(ones)):
        change = torch.zeros_like(ones)
        change[column] = 1e-7
        torch.testing.assert_close(
            slopes[:, column],
            (last(ones + change) - end) / 1e-7,
            rtol=1e-4,
            atol=1e-6 * float(slopes.abs().max()),
        )


def joint_with(effect: str, **values: float) -> Simulator:
    return Simulator(JOINT, (FittedEffect(effect_by_key("joint", effect), values),))


@pytest.mark.parametrize("samples", [0, 1, 3, 29])
def test_a_delayed_command_acts_that_many_samples_later(samples):
    volts = torch.zeros(2, 40, dtype=torch.float64)
    volts[:, 5:] = 6.0
    initial = torch.zeros(2, 2, dtype=torch.float64)
    prompt = rollout(Simulator(JOINT), initial, {"voltage": volts}, 0.01)
    late = rollout(joint_with("command_delay", delay=samples * 0.01), initial, {"voltage": volts}, 0.01)
    torch.testing.assert_close(late[:, samples:], prompt[:, : 41 - samples])
    torch.testing.assert_close(
        late[:, : 5 + samples + 1], torch.zeros(2, 5 + samples + 1, 2, dtype=torch.float64)[:, :41]
    )


def test_a_delay_between_samples_lies_between():
    volts = torch.zeros(1, 20, dtype=torch.float64)
    volts[:, 3:] = 6.0
    initial = torch.zeros(1, 2, dtype=torch.float64)
    velocity = [
        rollout(joint_with("command_delay", delay=delay), initial, {"voltage": volts}, 0.01)[0, -1, 1]
        for delay in (0.02, 0.024, 0.03)
    ]
    assert velocity[0] > velocity[1] > velocity[2]


def test_the_drive_of_a_swerve_may_be_late_while_its_steering_is_prompt():
    effect = effect_by_key("swerve", "command_delay@drive")
    simulator = Simulator(SWERVE, (FittedEffect(effect, {"delay": 0.03}),))
    volts = torch.zeros(1, 8, 4, dtype=torch.float64)
    volts[:, 1:] = 6.0
    initial = torch.zeros(1, 12, dtype=torch.float64)
    states = rollout(simulator, initial, {"drive_voltage": volts, "steer_voltage": volts}, 0.01)[0]
    moving = states.abs() > 1e-9
    assert int(moving[:, 0].int().argmax()) == 5
    assert int(moving[:, 7].int().argmax()) == 2


def test_with_a_limit_on_its_current_an_axis_starts_no_faster_than_that():
    limit = 1.5
    volts = {"voltage": torch.full((1, 10), 12.0, dtype=torch.float64)}
    states = rollout(
        joint_with("current_limit", limit=limit), torch.zeros(1, 2, dtype=torch.float64), volts, 0.002
    )
    most = limit * JOINT.motor.torque_constant * JOINT.motor.gear_ratio / JOINT.inertia
    time = torch.arange(11, dtype=torch.float64) * 0.002
    assert (states[0, :, 1] <= most * time * (1 + 1e-12)).all()
    torch.testing.assert_close(
        states[0, 1, 1], torch.tensor(most * 0.002, dtype=torch.float64), rtol=1e-3, atol=0.0
    )


def test_parameter_errors_scale_what_the_motion_divides_by():
    simulator = joint_with("inertia_error", ratio=2.0)
    effort = {"effort": torch.full((1, 1), 0.1, dtype=torch.float64)}
    initial = torch.zeros(1, 2, dtype=torch.float64)
    heavy, light = (rollout(s, initial, effort, 1e-4)[0, 1, 1] for s in (simulator, Simulator(JOINT)))
    torch.testing.assert_close(2.0 * heavy, light, rtol=1e-5, atol=0.0)
