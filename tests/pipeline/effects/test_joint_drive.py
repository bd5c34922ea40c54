"""The drive, the coupling and the velocity sensor of a joint against what is known exactly of them."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from torch import Tensor

from simgap.effects import effect_by_key
from simgap.physics.weak_form import mean_of, mean_rate_of, window_functions
from simgap.platforms import Joint
from simgap.simulation import FittedEffect, Simulator, rollout
from tests.pipeline.platforms.machines import JOINT

STEP = 0.002  # s


def stepped(name: str, samples: int) -> dict[str, Tensor]:
    """Return an axis at a constant speed whose input (1, 1 + samples) jumps from 0 to 1."""
    jump = torch.cat([torch.zeros(1, 1), torch.ones(1, samples)], dim=1).double()
    still = torch.zeros_like(jump)
    return {"position": still, "velocity": still + 3.0, name: jump}


def simulator(name: str, **values: float) -> Simulator:
    return Simulator(JOINT, (FittedEffect(effect_by_key("joint", name), values),))


@pytest.mark.parametrize("name", ["voltage", "effort"])
def test_a_slow_drive_covers_a_step_exponentially_and_leaves_the_back_emf(name):
    """The mean over each time step is that of 1 − e^(−t/τ)."""
    lag, samples = 0.03, 100
    found = simulator("motor_lag", time_constant=lag).along_time(stepped(name, samples), STEP)
    start = STEP * torch.arange(samples, dtype=torch.float64)
    rise = 1.0 - lag / STEP * (torch.exp(-start / lag) - torch.exp(-(start + STEP) / lag))
    torch.testing.assert_close(found[name][0, 1:], rise)
    if name == "voltage":
        motor = JOINT.motor
        constant = motor.torque_constant * motor.gear_ratio
        expected = constant * (rise - constant * 3.0) / motor.resistance
        torch.testing.assert_close(found["effort"][0, 1:], expected)


@given(ratio=st.floats(0.3, 3.0))
def test_a_scale_of_the_input_scales_what_acts_and_neither_load_nor_back_emf(ratio):
    for name in ("voltage", "effort"):
        signals = stepped(name, 5)
        scaled = {**signals, name: ratio * signals[name]}
        found = simulator("input_scale_error", ratio=ratio).along_time(signals, STEP)
        expected = Simulator(JOINT).along_time(scaled, STEP)
        torch.testing.assert_close(found["effort"], expected["effort"])


COUPLING = {"frequency": 8.0, "damping_ratio": 0.08, "motor_inertia_share": 0.4}
LOAD = (1.0 - COUPLING["motor_inertia_share"]) * JOINT.inertia
PACE = 2.0 * math.pi * COUPLING["frequency"]
SPRING, DAMPER = LOAD * PACE**2, 2.0 * COUPLING["damping_ratio"] * LOAD * PACE


def two_masses(times: np.ndarray, braking: float = 0.0) -> np.ndarray:
    """Return position and velocity of load and motor (4, samples) under `push`, the shaft at first as it is at rest."""

    def rates(time: float, state: np.ndarray) -> list[float]:
        load, fast, motor, faster = state
        shaft = SPRING * (motor - load) + DAMPER * (faster - fast)
        driven = push(time) - braking * faster - shaft
        return [fast, shaft / LOAD, faster, driven / (JOINT.inertia - LOAD)]

    first = [0.0, 0.0, push(0.0) / SPRING, 0.0]
    return solve_ivp(rates, (0.0, times[-1]), first, t_eval=times, rtol=1e-9, atol=1e-12).y


def push(time: float) -> float:
    return 0.2 + 0.3 * math.sin(6.0 * math.pi * time)


def coupled(platform: Joint, position_unit: str = "rad") -> Simulator:
    effect = effect_by_key("joint", "flexible_coupling")
    return Simulator(platform, (FittedEffect(effect, COUPLING),), position_unit)


CONSTANT = JOINT.motor.torque_constant * JOINT.motor.gear_ratio
PER_VOLT = CONSTANT / JOINT.motor.resistance


@pytest.mark.parametrize("step", [0.01, 0.005])
@pytest.mark.parametrize("driven", ["effort", "voltage"])
def test_two_coupled_masses_move_as_their_equations_say(step, driven):
    """A voltage acts on the motor, whose back-EMF follows its own speed."""
    times = step * np.arange(round(1.0 / step) + 1)
    motor, size = (JOINT.motor, PER_VOLT) if driven == "voltage" else (None, 1.0)
    held = torch.tensor([[push(time + 0.5 * step) / size for time in times[:-1]]], dtype=torch.float64)
    initial = torch.zeros(1, 2, dtype=torch.float64)
    found = rollout(coupled(Joint(JOINT.inertia, motor=motor)), initial, {driven: held}, step)[
        0, :, 0
    ].numpy()
    expected = two_masses(times, CONSTANT * PER_VOLT if motor else 0.0)[0]
    assert np.abs(found - expected).max() < 1e-3 * np.abs(expected).max() * (step / 0.005) ** 2


@pytest.mark.parametrize("driven", ["effort", "voltage"])
def test_along_a_recording_the_effort_is_that_of_the_shaft_and_of_the_inertia_that_it_carries(driven):
    """A voltage acts on the motor, whose back-EMF follows its own speed."""
    times = 1e-3 * np.arange(1201)
    platform = Joint(JOINT.inertia, motor=JOINT.motor if driven == "voltage" else None)
    load, fast, motor, faster = two_masses(times, CONSTANT * PER_VOLT if driven == "voltage" else 0.0)
    pushed = np.array([push(time) for time in times]) / (PER_VOLT if driven == "voltage" else 1.0)
    series = {"position": load, "velocity": fast, driven: pushed}
    signals = {name: torch.from_numpy(values)[None] for name, values in series.items()}
    found = coupled(platform).along_time(signals, 1e-3)["effort"][0].numpy()
    shaft = SPRING * (motor - load) + DAMPER * (faster - fast)
    expected = (
        JOINT.inertia / LOAD * shaft
    )  # no other load: shaft and the motor's inertia, carried by the load
    late = times > 0.6
    assert np.abs(found - expected)[late].max() < 5e-3 * np.abs(expected).max()


def filtered_swing(lag: float, noise: float = 0.0, samples: int = 2000) -> tuple[dict[str, Tensor], Tensor]:
    """Return what a filtered velocity sensor reads of a swing, and the true velocity, (1, samples) each."""
    time = STEP * torch.arange(samples, dtype=torch.float64)[None]
    random = torch.Generator().manual_seed(1)
    position, velocity, read = (torch.zeros_like(time) for _ in range(3))
    for pace, phase in ((3.0, 0.2), (11.0, 1.0), (40.0, 2.0)):
        angle, gain = pace * time + phase, 1.0 / math.hypot(1.0, pace * lag)
        position += torch.sin(angle) / pace
        velocity += torch.cos(angle)
        read += gain * torch.cos(angle - math.atan(pace * lag))
    disturbed = (
        series + size * torch.randn(time.shape, generator=random, dtype=torch.float64)
        for series, size in ((position, 0.1 * noise * STEP), (read, noise))
    )
    return dict(zip(("position", "velocity"), disturbed, strict=True)), velocity


@pytest.mark.parametrize("lag", [0.0, 0.001, 0.01, 0.1])
def test_the_inverse_of_the_filter_gives_the_velocity_back(lag):
    signals, velocity = filtered_swing(lag)
    undone = effect_by_key("joint", "velocity_filter").undo(signals, {"time_constant": lag}, STEP)
    settled = slice(10, -10)
    torch.testing.assert_close(undone["velocity"][:, settled], velocity[:, settled], rtol=0.0, atol=2e-3)
    assert torch.equal(undone["position"], signals["position"])


@pytest.mark.parametrize("lag", [0.02, 0.2])
def test_the_inverse_does_not_grow_the_noise_with_the_time_constant(lag):
    """Of the velocity alone it would be lag · √2 / step, here 14 and 140 times the noise."""
    noise = 0.05
    signals, velocity = filtered_swing(lag, noise)
    undone = effect_by_key("joint", "velocity_filter").undo(signals, {"time_constant": lag}, STEP)
    error = (undone["velocity"] - velocity)[:, 500:-10]
    assert float(error.std()) < 1.2 * noise


@pytest.mark.parametrize("lag", [0.005, 0.03])
def test_the_time_constant_of_a_filter_comes_back_from_the_equation_of_motion(lag):
    """Scanned finely, the momentum of the velocity without the filter balances a known effort best at the truth."""
    signals, velocity = filtered_swing(lag, noise=0.01)
    (effort,) = torch.gradient(JOINT.inertia * velocity, spacing=STEP, dim=1)
    functions, effect = (
        window_functions(velocity.shape[1], 0.1, STEP),
        effect_by_key("joint", "velocity_filter"),
    )

    def error(constant: float) -> float:
        undone = effect.undo(signals, {"time_constant": constant}, STEP)["velocity"]
        left = mean_rate_of(functions, JOINT.inertia * undone) - mean_of(functions, effort)
        return float(left[:, 2:-2].square().sum())

    scanned = [lag * factor for factor in np.linspace(0.5, 1.5, 101)]
    assert min(scanned, key=error) == pytest.approx(lag, rel=0.03)
