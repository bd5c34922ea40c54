"""Laws that hold for whole groups of effects: friction dissipates, limits are kept, delays are exact."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.effects import ActuatorEffect, CommandEffect, effect_by_key, effects_of
from simgap.effects.dry_friction import Sliding, dry_friction
from simgap.simulation import FittedEffect, Simulator, rollout
from tests.pipeline.effects.responses import TIME_STEP, actuated, constants
from tests.pipeline.platforms.machines import MACHINES, SWERVE, identity, some_signals

EVERYWHERE = [effect for kind in MACHINES for effect in effects_of(kind)]
FRICTIONS = [effect for effect in EVERYWHERE if effect.name.endswith("_friction")]
DRY = [effect for effect in FRICTIONS if effect.name == "coulomb_friction"]
DRAGS = [effect for effect in effects_of("quadrotor") if effect.name.endswith("_drag")]
LIMITS = [effect for effect in EVERYWHERE if effect.name == "current_limit"]
DELAYS = [
    effect for effect in EVERYWHERE if isinstance(effect, CommandEffect) and effect.name == "command_delay"
]


def consistent(kind: str, signals: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    """Return the signals with wheels that roll as the chassis moves, and actuated."""
    simulator = Simulator(MACHINES[kind])
    if kind == "swerve":
        from simgap.simulation.motion import motion_of

        motion = motion_of(SWERVE)
        signals = signals | motion.signals(motion.pack(signals))
    return simulator.mechanism.actuate(signals, simulator.constants())


def power(effect, signals: dict[str, torch.Tensor]) -> torch.Tensor:
    """Return what an effect does to the motion, W or W/kg."""
    wrench = effect.wrench(signals, effect.defaults(), constants(effect.kind))
    speeds = {
        "quadrotor": lambda: {
            **{f"force_{axis}": signals["velocity"][..., i] for i, axis in enumerate("xyz")},
            **{f"torque_{axis}": signals["body_rate"][..., i] for i, axis in enumerate("xyz")},
        },
        "swerve": lambda: {
            **{
                f"drive_{axis}": signals["chassis_velocity"][..., i]
                for i, axis in enumerate(("x", "y", "yaw"))
            },
            **{f"steer_{module + 1}": signals["steer_velocity"][..., module] for module in range(4)},
        },
        "joint": lambda: {"torque": signals["velocity"]},
    }[effect.kind]()
    return torch.stack([value * speeds[name] for name, value in wrench.items()]).sum(0)


@pytest.mark.parametrize("effect", FRICTIONS + DRAGS, ids=identity)
@given(seed=st.integers(0, 10**6))
def test_friction_and_drag_take_power_from_whatever_moves(effect, seed):
    signals = some_signals(effect.kind, (20,), seed)
    if effect.kind == "joint":  # fast enough to slide
        signals["velocity"] = signals["velocity"] + 0.1 * torch.sign(signals["velocity"])
    taken = -power(effect, consistent(effect.kind, signals))
    assert taken.max() > 0
    # What holds still creeps, ever less the faster it slides; on a swerve some of four axles may be slow.
    held = 4.0 * sum(v for name, v in effect.defaults().items() if name.endswith("level"))
    slow = 0.3 * held * constants("swerve")["drive_sliding_velocity"] if effect.kind == "swerve" else 0.0
    assert (taken >= -1e-6 * taken.max() - slow).all()


@given(
    speed=st.floats(-5.0, 5.0),
    applied=st.floats(-50.0, 50.0),
    level=st.floats(0.0, 20.0, allow_subnormal=False),  # which have no relative precision
    sliding=st.floats(1e-4, 1.0),
)
def test_dry_friction_opposes_motion_is_never_above_its_level_and_holds_no_more_than_is_applied(
    speed, applied, level, sliding
):
    """Only in the creep below the sliding velocity may holding have a power, and then next to none."""
    velocity, load = (torch.tensor(v, dtype=torch.float64) for v in (speed * sliding, applied))
    slides = Sliding(sliding, within_samples=False)
    friction = dry_friction(level, velocity, load, slides)
    assert abs(float(friction)) <= level * (1 + 1e-12)
    if abs(speed) >= 1.0:
        assert float(friction * velocity) <= 0.0
    assert float(friction * velocity) <= 0.3 * level * sliding
    assert float(dry_friction(level, velocity, torch.zeros_like(load), slides) * velocity) <= 0.0
    at_rest = float(dry_friction(level, torch.zeros_like(load), load, slides))
    assert at_rest == pytest.approx(-max(-level, min(level, applied)))


@given(
    velocity=st.floats(-2.0, 2.0),
    change=st.floats(0.01, 2.0),
    forward=st.floats(0.0, 20.0),
    backward=st.floats(0.0, 20.0),
)
def test_an_axis_that_turns_round_within_a_sample_feels_the_mean_of_both_directions(
    velocity, change, forward, backward
):
    """Driven so hard that nothing holds it, its velocity is a line through the sample."""
    passed = velocity + change * (torch.arange(4000, dtype=torch.float64) / 4000 - 0.5)
    expected = float(torch.where(passed > 0, -forward, backward).mean())
    mean, hard = (torch.tensor(v, dtype=torch.float64) for v in (velocity, 1e9))
    slides = Sliding(torch.tensor(0.5 * change, dtype=torch.float64), within_samples=True)
    found = float(dry_friction(forward, mean, hard, slides, backward))
    assert found == pytest.approx(expected, abs=1e-3 * (forward + backward) + 1e-6)


@given(applied=st.floats(-5.0, 5.0))
def test_an_axis_that_stands_for_a_whole_sample_is_held(applied):
    slides = Sliding(torch.tensor(0.1, dtype=torch.float64), within_samples=True)
    still, load = torch.zeros((), dtype=torch.float64), torch.tensor(applied, dtype=torch.float64)
    assert float(dry_friction(6.0, still, load, slides)) == pytest.approx(-applied)


@given(applied=st.floats(-50.0, 50.0), seeming=st.floats(-5.0, 5.0))
def test_an_axis_that_is_known_to_rest_is_held_up_to_the_level_whatever_its_sensor_says(applied, seeming):
    slides = Sliding(torch.tensor(0.1, dtype=torch.float64), within_samples=True, resting=1.0)
    velocity, load = (torch.tensor(value, dtype=torch.float64) for value in (seeming, applied))
    assert float(dry_friction(6.0, velocity, load, slides)) == pytest.approx(-max(-6.0, min(6.0, applied)))


@pytest.mark.parametrize("effect", DRY, ids=identity)
@pytest.mark.parametrize("share", [0.5, 0.99, 1.5])
def test_dry_friction_holds_up_to_its_level_and_no_further(effect, share):
    machine = MACHINES[effect.kind]
    level = effect.defaults()["level"]
    if effect.kind == "joint":
        commands = {"effort": torch.full((1, 40), share * level, dtype=torch.float64)}
        initial = torch.zeros(1, 2, dtype=torch.float64)
    else:
        axis = machine.drive if effect.acts_on == "drive" else machine.steer
        voltage = share * level / (axis.gear_ratio * axis.motor.torque_constant) * axis.motor.resistance
        still = torch.zeros(1, 40, 4, dtype=torch.float64)
        commands = {"drive_voltage": still, "steer_voltage": still} | {
            f"{effect.acts_on}_voltage": still + voltage
        }
        initial = torch.zeros(1, 12, dtype=torch.float64)
    states = rollout(Simulator(machine, (FittedEffect(effect, {"level": level}),)), initial, commands, 0.01)
    moved = float((states[:, -1] - initial).abs().max())
    assert moved < 1e-12 if share < 1 else moved > 1e-4


def test_a_pendulum_comes_to_rest_off_centre_no_further_than_friction_can_hold():
    effect = effect_by_key("joint", "coulomb_friction")
    joint = MACHINES["joint"]
    level = 0.2
    sliding = 0.1  # rad/s; wide enough for the step to resolve the creep
    friction = FittedEffect(effect, {"level": level})
    simulator = Simulator(joint, (friction,), settings={"sliding_velocity": sliding})
    commands = {"effort": torch.zeros(3, 150, dtype=torch.float64)}
    initial = torch.tensor([[1.0, 0.0], [-0.7, 3.0], [0.05, 0.0]], dtype=torch.float64)
    states = rollout(simulator, initial, commands, 0.01)
    position, velocity = states.unbind(-1)
    energy = (
        0.5 * joint.inertia * velocity**2
        + joint.gravity_torque * (1 - torch.cos(position))
        + 0.5 * joint.stiffness * position**2
    )
    assert (torch.diff(energy, dim=1) <= 0.3 * level * sliding * 0.01).all()
    assert (velocity[:, -1].abs() < 0.02).all()
    load = joint.gravity_torque * torch.sin(position) + joint.stiffness * position
    assert (load[:, -1].abs() <= level * 1.01).all()
    torch.testing.assert_close(position[2], torch.full_like(position[2], 0.05))


@pytest.mark.parametrize("effect", LIMITS, ids=identity)
@given(seed=st.integers(0, 10**6), limit=st.floats(0.1, 400.0))
def test_a_current_limit_is_never_exceeded_and_bites_only_above_itself(effect, seed, limit):
    signals = actuated(effect.kind, some_signals(effect.kind, (2, 20), seed))
    numbers = constants(effect.kind)
    if effect.kind == "joint":
        name, constant = "effort", numbers["torque_constant"] * numbers["gear_ratio"]
    else:
        group = effect.acts_on
        name, constant = (
            f"{group}_torque",
            numbers[f"{group}_torque_constant"] * numbers[f"{group}_gear_ratio"],
        )
    wanted = signals[name] / constant
    current = effect.along_time(signals, {"limit": limit}, numbers, TIME_STEP)[name] / constant
    assert (current.abs() <= limit * (1 + 1e-12)).all()
    below = wanted.abs() <= limit * (1 - 1e-9)
    assert torch.equal(current[below], wanted[below])
    assert (current * wanted >= 0).all()


@pytest.mark.parametrize("effect", DELAYS, ids=identity)
@given(samples=st.integers(0, 30), seed=st.integers(0, 10**6))
def test_a_delay_of_whole_samples_is_that_many_samples(effect, samples, seed):
    signals = actuated(effect.kind, some_signals(effect.kind, (2, 50), seed))
    delayed = effect.along_time(signals, {"delay": samples * 0.01}, constants(effect.kind), 0.01)
    for name in set(effect.delayed) & signals.keys():
        late, start = delayed[name], signals[name][:, :1].expand_as(signals[name][:, :samples])
        torch.testing.assert_close(late[:, samples:], signals[name][:, : 50 - samples])
        torch.testing.assert_close(late[:, :samples], start)
    for name in signals.keys() - set(effect.delayed):
        assert torch.equal(delayed[name], signals[name])


@given(offset=st.integers(-8, 8))
def test_a_time_offset_moves_the_motors_to_the_clock_of_the_state(offset):
    effect = effect_by_key("quadrotor", "sensor_time_offset")
    signals = some_signals("quadrotor", (2, 50), seed=1)
    undone = effect.undo(signals, {"offset": offset * 0.01}, 0.01)
    inside = slice(10, 40)
    moved = signals["rotor_speed"][:, inside.start - offset : inside.stop - offset]
    torch.testing.assert_close(undone["rotor_speed"][:, inside], moved)
    assert torch.equal(undone["velocity"], signals["velocity"])


def test_every_memory_is_said():
    """An effect that is given whole blocks at once must not need what came before."""
    for effect in EVERYWHERE:
        if isinstance(effect, ActuatorEffect) and not effect.remembers:
            signals = actuated(effect.kind, some_signals(effect.kind, (2, 5), seed=1))
            _, memory = effect.actuate(signals, effect.defaults(), constants(effect.kind), None, TIME_STEP)
            assert memory is None
