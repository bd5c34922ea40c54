"""A slung payload is a pendulum, and pulls back on what carries it."""

import math

import pytest
import torch

from simgap.effects import effect_by_key
from simgap.physics import rotations
from simgap.physics.cable import Cable, across, along
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.motion import motion_of
from tests.pipeline.effects.responses import constants, smooth_flight
from tests.pipeline.platforms.machines import QUADROTOR

PAYLOAD = effect_by_key("quadrotor", "slung_payload")
GRAVITY = QUADROTOR.gravity


def swinging(angle: float, length: float, samples: int, time_step: float) -> torch.Tensor:
    """Return the pull (samples, 3) on a hovering machine whose load is let go at an angle."""
    upright = torch.zeros(1, samples, 3, dtype=torch.float64)
    upright[..., 2] = GRAVITY
    upright[:, 0] = GRAVITY * torch.tensor([-math.sin(angle), 0.0, math.cos(angle)], dtype=torch.float64)
    signals = {
        "attitude": torch.tensor([1.0, 0.0, 0.0, 0.0], dtype=torch.float64).expand(1, samples, 4),
        "velocity": torch.zeros_like(upright),
        "specific_force": upright,
    }
    values = {"mass_ratio": 0.1, "length": length}
    return PAYLOAD.along_time(signals, values, constants("quadrotor"), time_step)["payload_pull"][0]


@pytest.mark.parametrize("length", [0.1, 0.8, 5.0])
def test_a_small_swing_below_a_hovering_machine_has_the_period_of_a_pendulum(length):
    period = 2.0 * math.pi * math.sqrt(length / GRAVITY)
    side = swinging(0.01, length, 2001, period / 400)[:, 0]
    before = torch.nonzero(side[:-1] * side[1:] < 0).squeeze(1)
    crossings = (before + side[before] / (side[before] - side[before + 1])) / 400
    torch.testing.assert_close(torch.diff(crossings), torch.full((9,), 0.5).double(), rtol=2e-4, atol=0.0)


def test_the_cable_of_a_wide_swing_pulls_as_its_energy_says():
    """Released at rest at an angle, a pendulum pulls with g·(3 cos θ − 2 cos θ₀) on its way."""
    pull = swinging(1.2, 0.8, 4000, 1e-3)[1:]
    size = pull.norm(dim=-1)
    cosine = -pull[:, 2] / size
    torch.testing.assert_close(size, GRAVITY * (3.0 * cosine - 2.0 * math.cos(1.2)), rtol=0.0, atol=2e-2)
    assert float(size.max()) > 2.2 * GRAVITY


@pytest.mark.parametrize(("angle", "turning"), [(0.4, 0.5), (0.4, 3.0), (1.0, 0.5)])
def test_how_a_load_swings_when_a_recording_begins_is_found(angle, turning):
    """A swing that was on its way before pulls as it did, cut into stretches or not, also a wide or a fast one."""
    samples, time_step, margin = 400, 0.01, 20
    cable = Cable(0.8, GRAVITY, time_step)
    apparent = torch.zeros(1, samples, 3, dtype=torch.float64)
    apparent[..., 2] = -GRAVITY
    direction = torch.tensor([[math.sin(angle), 0.0, -math.cos(angle)]], dtype=torch.float64)
    rate = torch.tensor([[0.0, turning, 0.0]], dtype=torch.float64)
    for _ in range(30):  # the pull moves the machine, which moves the load
        directions, rates = cable.swings(direction, rate, apparent)
        tension = 0.8 * rates.square().sum(-1) + (directions * apparent).sum(-1)
        pull = tension[..., None] * directions
        apparent = torch.cat([-0.2 * pull[..., :2], apparent[..., 2:]], dim=-1)
    lifted = -apparent
    signals = {
        "attitude": torch.tensor([1.0, 0.0, 0.0, 0.0], dtype=torch.float64).expand(1, samples, 4),
        "velocity": torch.zeros_like(lifted),
        "specific_force": lifted,
        "elapsed": time_step * torch.arange(samples, dtype=torch.float64)[None],
        "run_number": torch.zeros(1, samples, dtype=torch.float64),
    }
    firsts = (0, samples // 2 - 2 * margin)
    cut = {
        name: torch.cat([series[:, first : first + samples // 2 + 2 * margin] for first in firsts])
        for name, series in signals.items()
    }
    values = {"mass_ratio": 0.2, "length": 0.8}
    found = PAYLOAD.along_time(cut, values, constants("quadrotor"), time_step)["payload_pull"]
    for part, first in zip(found, firsts, strict=True):
        known = pull[0, first : first + len(part)]
        assert float((part - known)[:, :2].abs().max()) < 0.3
    hanging = {name: series for name, series in cut.items() if name != "run_number"}
    missed = PAYLOAD.along_time(hanging, values, constants("quadrotor"), time_step)["payload_pull"]
    assert float((missed[0] - pull[0, : missed.shape[1]])[:, :2].abs().max()) > 1.0


def test_compiled_steps_are_those_that_gradients_go_through():
    random = torch.Generator().manual_seed(4)
    direction, rate, apparent = (
        torch.randn(5, *shape, generator=random, dtype=torch.float64) for shape in ((3,), (3,), (200, 3))
    )
    start = along(direction), across(3.0 * rate, along(direction))
    cable = Cable(0.7, GRAVITY, 0.01)
    compiled = cable.steps(*start, 5.0 * apparent, stride=2)
    differentiable = cable.steps(*start, (5.0 * apparent).requires_grad_(), stride=2)
    for one, other in zip(compiled, differentiable, strict=True):
        assert other.requires_grad
        torch.testing.assert_close(one, other.detach(), rtol=1e-9, atol=1e-9)


def test_a_hanging_load_is_weight():
    pull = swinging(0.0, 0.8, 50, 0.01)
    signals = {
        "attitude": torch.tensor([[1.0, 0.0, 0.0, 0.0]] * 50, dtype=torch.float64),
        "payload_pull": pull,
    }
    wrench = PAYLOAD.wrench(signals, {"mass_ratio": 0.3, "length": 0.8}, constants("quadrotor"))
    torch.testing.assert_close(wrench["force_z"], torch.full((50,), -0.3 * GRAVITY, dtype=torch.float64))
    assert not wrench["force_x"].any()


def test_a_falling_load_does_not_push():
    free = torch.zeros(1, 20, 3, dtype=torch.float64)
    attitude = torch.tensor([1.0, 0.0, 0.0, 0.0], dtype=torch.float64).expand(1, 20, 4)
    signals = {"attitude": attitude, "velocity": free, "specific_force": free}
    pull = PAYLOAD.along_time(signals, PAYLOAD.defaults(), constants("quadrotor"), 0.01)["payload_pull"]
    assert float(pull.abs().max()) < 1e-30


def test_velocities_and_an_accelerometer_tell_of_the_same_swing():
    samples, time_step = 1000, 1e-3
    signals = smooth_flight(samples, duration=1.0)
    world = rotations.rotate(signals["attitude"], signals["velocity"])
    (acceleration,) = torch.gradient(world, spacing=time_step, dim=1)
    lifted = acceleration + torch.tensor([0.0, 0.0, GRAVITY], dtype=torch.float64)
    measured = signals | {"specific_force": rotations.rotate_inverse(signals["attitude"], lifted)}
    numbers = constants("quadrotor")
    found, expected = (
        PAYLOAD.along_time(given, PAYLOAD.defaults(), numbers, time_step)["payload_pull"]
        for given in (measured, signals)
    )
    torch.testing.assert_close(found, expected)


def test_a_machine_and_its_load_swing_against_each_other():
    """Free to move, the pair swings faster by √(1 + mass ratio) about its common centre, which thrust carries along.

    The machine is tilted a little and its load hangs straight at first: v = g·tilt·(t + mass ratio/ω · sin ωt). The
    pull is held through each step, so that the swing comes late by about the step, here a twentieth of a radian.
    """
    mass_ratio, tilt, length, time_step = 0.4, 0.01, 0.5, 0.01
    pace = math.sqrt(GRAVITY / length * (1.0 + mass_ratio))
    steps = round(2.0 * math.pi / pace / time_step)
    simulator = Simulator(QUADROTOR, (FittedEffect(PAYLOAD, {"mass_ratio": mass_ratio, "length": length}),))
    speed = QUADROTOR.hover_rotor_speed * math.sqrt(1.0 + mass_ratio)
    commands = {"rotor_speed": torch.full((1, steps, 4), speed, dtype=torch.float64)}
    still = torch.zeros(1, 3, dtype=torch.float64)
    attitude = rotations.from_rotation_vector(torch.tensor([[0.0, tilt, 0.0]], dtype=torch.float64))
    initial = motion_of(QUADROTOR).pack(
        {"position": still, "attitude": attitude, "velocity": still, "body_rate": still}
    )
    velocity = rollout(simulator, initial, commands, time_step)[0, :, 7]
    time = torch.arange(steps + 1, dtype=torch.float64) * time_step
    swing = velocity / (GRAVITY * tilt) - time
    amplitude = mass_ratio / pace
    assert float((swing - amplitude * torch.sin(pace * time)).abs().max()) < 0.1 * amplitude
