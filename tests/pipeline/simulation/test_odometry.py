"""Motion that nobody measured: the wheels show the same to every simulator, and each moves by its own wheels."""

import pytest
import torch

from simgap.effects import effect_by_key
from simgap.platforms.swerve_mechanism import ROLLED, twist_from_wheels
from simgap.simulation import FittedEffect, Simulator, replay, rollout
from simgap.simulation.blocks import Blocks
from simgap.simulation.motion import motion_of
from tests.pipeline.platforms.machines import SWERVE

TIME_STEP, RUNS, SAMPLES, MARGIN = 2e-3, 3, 300, 50
EFFECTS = {
    "wheel_radius_error@drive": {"ratio": 0.9},
    "module_misalignment@chassis": {f"offset_{n}": 0.1 for n in range(1, 5)} | {"cornering_stiffness": 15.0},
}


def with_effects(*keys: str) -> Simulator:
    return Simulator(SWERVE, tuple(FittedEffect(effect_by_key("swerve", key), EFFECTS[key]) for key in keys))


def rolled(machine: Simulator) -> Blocks:
    """Return blocks of a machine whose modules all turn alike, with its motion as the platform's wheels show it."""
    time = TIME_STEP * torch.arange(SAMPLES, dtype=torch.float64)
    size = torch.linspace(3.0, 9.0, RUNS, dtype=torch.float64)[:, None, None]
    commands = {
        "drive_voltage": (size * torch.cos(2.0 * time)[None, :, None]).expand(-1, -1, 4),
        "steer_voltage": (0.1 * size * torch.sin(9.0 * time)[None, :, None]).expand(-1, -1, 4),
    }
    initial = torch.zeros(RUNS, 12, dtype=torch.float64)
    states = rollout(machine, initial, commands, TIME_STEP)[:, :-1]
    signals = motion_of(SWERVE).signals(states, machine.constants()) | commands
    twist = twist_from_wheels(signals, Simulator(SWERVE).constants())
    return Blocks(
        signals=signals | {ROLLED: twist, "chassis_velocity": twist},
        run=torch.arange(RUNS),
        runs=tuple(f"run{run}" for run in range(RUNS)),
        start=torch.zeros(RUNS, dtype=torch.float64),
        time_step=TIME_STEP,
        margin=MARGIN,
        samples=SAMPLES - 2 * MARGIN,
        held_commands=commands,
    )


def error_of(simulator: Simulator, blocks: Blocks) -> float:
    """Return the greatest error of a replay over the largest recorded speed."""
    inner = {name: blocks.inner(series) for name, series in blocks.signals.items()}
    recorded = motion_of(SWERVE, blocks.signals).pack(inner)
    steps = blocks.samples - 1
    predicted = replay(simulator, blocks, recorded[:, 0], steps)
    return float((predicted - recorded)[..., :2].abs().max() / recorded[..., :2].abs().max())


@pytest.mark.slow
@pytest.mark.parametrize("keys", [[key] for key in EFFECTS] + [list(EFFECTS)], ids=str)
def test_the_true_simulator_shows_the_recorded_wheels_again(keys):
    machine = with_effects(*keys)
    blocks = rolled(machine)
    error = error_of(machine, blocks)
    assert error < 2e-3
    assert error < 0.2 * error_of(Simulator(SWERVE), blocks)
