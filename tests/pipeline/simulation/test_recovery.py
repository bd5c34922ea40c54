"""What is planted together in a simulator is found again, by least squares on the regressors of the diagnosis."""

import pytest
import torch
from torch import Tensor

from simgap.effects import effect_by_key, effects_of
from simgap.effects.effect import ActuatorEffect, WrenchEffect
from simgap.physics import rotations
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.motion import motion_of
from tests.pipeline.platforms.machines import JOINT, QUADROTOR
from tests.pipeline.simulation.flights import smooth

STEP = 0.002


def held(shape: tuple[int, ...], every: int, seed: int) -> Tensor:
    """Return random commands between −1 and 1, held for some samples each."""
    random = torch.Generator().manual_seed(seed)
    few = (
        2.0 * torch.rand((shape[0], -(-shape[1] // every), *shape[2:]), generator=random, dtype=torch.float64)
        - 1.0
    )
    return few.repeat_interleave(every, dim=1)[:, : shape[1]]


def over_a_step(series: Tensor) -> Tensor:
    """Return the mean of both ends of each step."""
    return 0.5 * (series[:, 1:] + series[:, :-1])


def planted_and_found(
    planted: dict[str, dict[str, float]], states: Tensor, commands: dict[str, Tensor]
) -> None:
    """Fit all planted effects together to the momentum that changed over each step, and compare."""
    effects = [effect_by_key("quadrotor", name) for name in planted]
    simulator, motion = Simulator(QUADROTOR), motion_of(QUADROTOR)
    signals = {name: over_a_step(series) for name, series in motion.signals(states).items()}
    signals["attitude"] = rotations.normalize(signals["attitude"])
    signals |= commands
    ends = simulator.balance(simulator.along_time(motion.signals(states) | ends_of(commands), STEP)).momentum
    rate = simulator.balance(simulator.along_time(signals, STEP)).rate
    constants = simulator.constants()
    columns = [column for effect in effects for column in effect.regressors(signals, constants)]
    rows, target = [], []
    for channel in simulator.mechanism.channels:
        weight = 1.0 / simulator.nominal_inertia()[channel.name]
        change = torch.diff(ends[channel.name], dim=1) / STEP - rate[channel.name]
        target.append(weight * change.flatten())
        zero = torch.zeros_like(change)
        rows.append(torch.stack([weight * c.get(channel.name, zero).flatten() for c in columns], dim=-1))
    found = torch.linalg.lstsq(torch.cat(rows), torch.cat(target)[:, None]).solution[:, 0]
    expected = [value for values in planted.values() for value in values.values()]
    assert found.tolist() == pytest.approx(expected, rel=0.01)


def ends_of(commands: dict[str, Tensor]) -> dict[str, Tensor]:
    return {name: torch.cat([series, series[:, -1:]], dim=1) for name, series in commands.items()}


def flown(planted: dict[str, dict[str, float]]) -> tuple[Tensor, dict[str, Tensor]]:
    """Fly random rotor speeds from random states, near the floor."""
    runs, steps = 8, 60
    random = torch.Generator().manual_seed(1)
    start = 2.0 * torch.rand((runs, 13), generator=random, dtype=torch.float64) - 1.0
    start[:, 2] = 0.4 + 0.2 * start[:, 2]
    start[:, 3:7] = rotations.normalize(start[:, 3:7] * 0.2 + torch.tensor([1.0, 0.0, 0.0, 0.0]))
    start[:, 7:10] *= 5.0
    start[:, 10:13] *= 3.0
    commands = {"rotor_speed": QUADROTOR.hover_rotor_speed * (1.0 + 0.15 * held((runs, steps, 4), 10, 2))}
    effects = tuple(
        FittedEffect(effect_by_key("quadrotor", name), values) for name, values in planted.items()
    )
    return rollout(Simulator(QUADROTOR, effects), start, commands, STEP), commands


# Of the state and the command alone: without hidden signals, each step of the momentum is an equation.
WRENCHES = [
    effect
    for effect in effects_of("quadrotor")
    if isinstance(effect, WrenchEffect) and effect.linear and not isinstance(effect, ActuatorEffect)
]


@pytest.mark.parametrize("absent", ["rotor_thrust_spread", "rotor_fault"])
def test_all_wrench_effects_of_a_quadrotor_come_back_together(absent):
    """Four broken rotors are also uneven ones: either are planted, since no flight tells both."""
    planted = {e.key: e.defaults() for e in WRENCHES if e.names_physics and e.name != absent}
    planted_and_found(planted, *flown(planted))


def test_friction_and_delay_of_a_joint_come_back_together():
    """The level and the delay bend the residual, so the least squares are repeated from where the last ones ended."""
    names = (("coulomb_friction", "level"), ("viscous_friction", "coefficient"), ("command_delay", "delay"))
    planted = torch.tensor([0.12, 0.03, 0.0133], dtype=torch.float64)

    def simulator(values: Tensor) -> Simulator:
        pairs = zip(names, values, strict=True)
        effects = tuple(FittedEffect(effect_by_key("joint", name), {entry: v}) for (name, entry), v in pairs)
        return Simulator(JOINT, effects)

    volts = {"voltage": 10.0 * smooth((6, 80), STEP, 3)}
    start = torch.tensor(
        [[0.0, velocity] for velocity in (-8.0, -5.0, -2.0, 2.0, 5.0, 8.0)], dtype=torch.float64
    )
    states = rollout(simulator(planted), start, volts, STEP)
    middle = {name: over_a_step(series) for name, series in motion_of(JOINT).signals(states).items()}
    change = JOINT.inertia * torch.diff(states[..., 1], dim=1) / STEP

    def residual(values: Tensor) -> Tensor:
        fitted = simulator(values)
        return (fitted.balance(fitted.along_time(middle | volts, STEP)).rate["torque"] - change).flatten()

    values = torch.tensor([0.0, 0.0, 0.005], dtype=torch.float64)
    for _ in range(5):
        jacobian = torch.autograd.functional.jacobian(residual, values)
        values = values - torch.linalg.lstsq(jacobian, residual(values)[:, None]).solution[:, 0]
        values = values.clamp_min(0.0)
    assert values.tolist() == pytest.approx(planted.tolist(), rel=0.01)
