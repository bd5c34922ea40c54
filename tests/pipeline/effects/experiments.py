"""Noise-free recordings of each kind of machine under an excitation that shows every effect, and their fit."""

from collections.abc import Mapping

import torch
from torch import Tensor

from simgap.effects import Effect, MeasurementEffect
from simgap.effects.shift import shift_in_time
from simgap.equations.fit import Fit, fit
from simgap.equations.problem import Problem
from simgap.equations.residuals import residual_rows
from simgap.equations.temper import temper_of
from simgap.physics import rotations
from simgap.physics.weak_form import window_functions
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.blocks import Blocks
from simgap.simulation.motion import motion_of
from tests.pipeline.platforms.machines import MACHINES, QUADROTOR

_NOISE = 1e-9  # of every row: the recordings have none, but weights need a floor
_TRIED = 2  # of the starting points, the best ones are followed


def waves(
    shape: tuple[int, ...], time_step: float, seed: int, frequencies: tuple[float, ...] = (0.9, 1.9, 3.1, 4.7)
) -> Tensor:
    """Return sums of sines with random phases within −1 and 1, time in the second dimension."""
    random = torch.Generator().manual_seed(seed)
    time = torch.arange(shape[1], dtype=torch.float64) * time_step
    total = torch.zeros(shape, dtype=torch.float64)
    for frequency in frequencies:
        phase = 6.3 * torch.rand((shape[0], 1, *shape[2:]), generator=random, dtype=torch.float64)
        angle = 6.283 * frequency * time.reshape(1, -1, *[1] * len(shape[2:]))
        total += torch.sin(angle + phase) / len(frequencies)
    return total


def joint_experiment(effect: Effect, time_step: float) -> tuple[Tensor, dict[str, Tensor]]:
    """Return where a joint starts and its voltage, while the battery sags and the motor warms up."""
    shape = (12, round(0.6 / time_step))
    slow = torch.linspace(0.0, 1.0, shape[1], dtype=torch.float64).expand(shape)
    initial = torch.linspace(-1.0, 1.0, 2 * shape[0], dtype=torch.float64).reshape(shape[0], 2)
    commands = {
        "voltage": 11.0 * waves(shape, time_step, seed=1),
        "battery_voltage": 13.0 - 3.0 * slow + 0.5 * waves(shape, time_step, seed=2),
        "temperature": 20.0 + 50.0 * slow,
    }
    return initial, commands


def quadrotor_experiment(effect: Effect, time_step: float) -> tuple[Tensor, dict[str, Tensor]]:
    """Return random states near the floor and rotors that shake a quadrotor about for half a second."""
    if effect.name == "slung_payload":
        return payload_experiment(effect, time_step)
    shape = (12, round(0.5 / time_step))
    random = torch.Generator().manual_seed(1)
    initial = 2.0 * torch.rand((shape[0], 13), generator=random, dtype=torch.float64) - 1.0
    initial[:, 2] = 0.6 + 0.2 * initial[:, 2]
    initial[:, 3:7] = rotations.normalize(initial[:, 3:7] * 0.2 + torch.tensor([1.0, 0.0, 0.0, 0.0]))
    initial[:, 7:10] *= torch.tensor([8.0, 8.0, 4.0])
    initial[:, 10:13] *= 2.0
    together, apart = waves((*shape, 1), time_step, seed=2), waves((*shape, 4), time_step, seed=4)
    speed = QUADROTOR.hover_rotor_speed * (1.0 + 0.3 * together + 0.12 * apart)
    battery = 14.0 + 1.5 * waves(shape, time_step, seed=3)
    if "motor_command" in effect.needs:
        return initial, {"motor_command": speed / QUADROTOR.motor_speed_max, "battery_voltage": battery}
    return initial, {"rotor_speed": speed, "battery_voltage": battery}


def payload_experiment(effect: Effect, time_step: float) -> tuple[Tensor, dict[str, Tensor]]:
    """Return a level start, from which a cable hangs straight down, and dashes to and fro for a few swings."""
    shape = (6, round(2.0 / time_step))
    random = torch.Generator().manual_seed(3)
    initial = torch.zeros(shape[0], 13, dtype=torch.float64)
    initial[:, 3] = 1.0
    time = torch.arange(shape[1], dtype=torch.float64) * time_step
    roll, pitch = torch.tensor([[-1.0, -1.0, 1.0, 1.0], [-1.0, 1.0, 1.0, -1.0]], dtype=torch.float64)
    apart = torch.zeros(*shape, 4, dtype=torch.float64)
    for frequency in (0.7, 1.3):
        sideways, forward = 2.0 * torch.rand((2, shape[0], 1), generator=random, dtype=torch.float64) - 1.0
        turning = sideways * roll + forward * pitch
        apart += 0.01 * frequency * torch.cos(6.283 * frequency * time)[:, None] * turning[:, None]
    carrying = (1.0 + effect.defaults()["mass_ratio"]) ** 0.5
    return initial, {"rotor_speed": QUADROTOR.hover_rotor_speed * carrying * (1.0 + apart)}


def swerve_experiment(effect: Effect, time_step: float) -> tuple[Tensor, dict[str, Tensor]]:
    """Return a swerve drive at rest with its modules anyhow, and voltages of either sign on all eight motors."""
    shape = (8, round(0.4 / time_step))
    initial = torch.zeros(shape[0], 12, dtype=torch.float64)
    commands = {
        "drive_voltage": 11.0 * waves((*shape, 4), time_step, seed=1),
        "steer_voltage": 9.0 * waves((*shape, 4), time_step, seed=2),
        "battery_voltage": 11.0 + waves(shape, time_step, seed=3),
    }
    return initial, commands


EXPERIMENTS = {"joint": joint_experiment, "quadrotor": quadrotor_experiment, "swerve": swerve_experiment}


def recorded_blocks(
    effect: Effect, values: Mapping[str, float], time_step: float = 2e-3, substeps: int = 1
) -> Blocks:
    """Return what a machine with one effect does in its experiment; each run is a block."""
    initial, commands = EXPERIMENTS[effect.kind](effect, time_step)
    measured = isinstance(effect, MeasurementEffect)
    machine = Simulator(MACHINES[effect.kind], () if measured else (FittedEffect(effect, values),))
    states = rollout(machine, initial, commands, time_step, substeps)[:, :-1]
    if measured:
        states = shift_in_time(states, values["offset"], time_step)
    around = {
        name: series
        if name in ("battery_voltage", "temperature")
        else 0.5 * (series + torch.cat([series[:, :1], series[:, :-1]], dim=1))
        for name, series in commands.items()
    }
    margin = states.shape[1] // 6
    return Blocks(
        signals=motion_of(machine.platform).signals(states, machine.constants()) | around,
        run=torch.arange(len(states)),
        runs=tuple(f"run{run}" for run in range(len(states))),
        start=torch.zeros(len(states), dtype=torch.float64),
        time_step=time_step,
        margin=margin,
        samples=states.shape[1] - 2 * margin,
    )


def recovered(effect: Effect, blocks: Blocks) -> dict[str, float]:
    """Return the parameters of an effect as a fit finds them from the effect's own starting points."""
    machine = Simulator(MACHINES[effect.kind])
    channels = len(machine.mechanism.channels_of(blocks.signals))
    noise = torch.full((channels,), _NOISE, dtype=torch.float64)
    functions = window_functions(blocks.samples, 0.05, blocks.time_step)
    problem = Problem(
        blocks, functions, noise, torch.zeros_like(noise), blocks.run, temper_of(blocks, functions, 0.05)
    )
    tried = effect.starts_in(blocks.signals, machine.constants())
    starts = [machine.with_effects((FittedEffect(effect, start),)) for start in tried]
    scale = residual_rows(machine, blocks, functions).square().mean((0, 1)).clamp_min(_NOISE**2)
    starts.sort(key=lambda start: _cost(residual_rows(start, blocks, functions), scale))
    fits = [fit(start, problem) for start in starts[:_TRIED]]
    best: Fit = min(fits, key=lambda found: _cost(found.residual, scale))
    return dict(best.simulator.effects[0].values)


def _cost(residual: Tensor, scale: Tensor) -> float:
    return float((residual.square() / scale).sum())
