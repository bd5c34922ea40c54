"""Hysteresis of a joint against what is known exactly of Bouc and Wen's law, and of Dahl's."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.optimize import least_squares
from torch import Tensor
from torch.fx.experimental.proxy_tensor import make_fx

from simgap.effects import effect_by_key
from simgap.physics.hysteresis_steps import MOST
from simgap.physics.tracing import traced_operations
from simgap.simulation import Simulator
from tests.pipeline.effects.responses import constants, numbers
from tests.pipeline.platforms.machines import JOINT

ASYMMETRIES = st.floats(-3.0, 3.0) | st.sampled_from([-1.0, 0.0, 1.0])


def some_steps(samples: int, seed: int) -> Tensor:
    """Return steps to and fro (samples,), about 0.1 each."""
    return 0.1 * torch.randn(samples, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)


def resistance(position: Tensor, displacement: float, asymmetry: float | Tensor = 0.0) -> Tensor:
    """Return the torque of unit hysteresis along one path (samples,)."""
    effect = effect_by_key("joint", "hysteresis")
    values = {"level": 1.0, "displacement": displacement, "asymmetry": asymmetry}
    signals = effect.along_time({"position": position[None]}, values, constants("joint"), 0.01)
    return effect.wrench(signals, values, constants("joint"))["torque"][0]


def test_hysteresis_is_a_spring_at_first_and_a_friction_in_the_end():
    position = torch.linspace(0.0, 1.0, 1001, dtype=torch.float64)
    torch.testing.assert_close(resistance(position, 0.1), torch.expm1(-position / 0.1))


@given(displacement=st.floats(0.01, 1.0), seed=st.integers(0, 10**6))
def test_symmetric_hysteresis_is_the_law_of_dahl(displacement, seed):
    position = torch.cumsum(some_steps(60, seed), 0)
    deflection, expected = 0.0, [0.0]
    for travel in torch.diff(position).tolist():
        way = math.copysign(1.0, travel)
        deflection = way + (deflection - way) * math.exp(-abs(travel) / displacement)
        expected.append(-deflection)
    torch.testing.assert_close(resistance(position, displacement), numbers(*expected))


@given(asymmetry=ASYMMETRIES, displacement=st.floats(0.05, 1.0), seed=st.integers(0, 10**6))
def test_hysteresis_keeps_its_differential_equation(asymmetry, displacement, seed):
    """The difference over a small way, from wherever some motion has led."""
    position = torch.cumsum(some_steps(20, seed), 0)
    small = 1e-6 * displacement
    for ahead in (small, -small):
        found = -resistance(torch.cat([position, position[-1:] + ahead]), displacement, asymmetry)
        before, after = found[-2:].tolist()
        size = math.hypot(1.0 + asymmetry, asymmetry)
        slope = (1.0 - (before * math.copysign(1.0, ahead) + asymmetry * abs(before)) / size) / displacement
        if abs(before) < 0.9 * MOST:
            assert (after - before) / ahead == pytest.approx(slope, rel=1e-4, abs=1e-3 / displacement)


@given(asymmetry=st.floats(-0.9, 3.0), level=st.floats(0.1, 10.0))
def test_hysteresis_settles_near_its_level_as_is_said(asymmetry, level):
    found = resistance(numbers(0.0, 100.0), 0.01, asymmetry)[-1]
    settled = level * math.hypot(1.0 + asymmetry, asymmetry) / (1.0 + asymmetry)
    assert settled < 1.03 * level or not -0.15 < asymmetry < 0.3
    assert -level * float(found) == pytest.approx(settled, rel=1e-6)
    values = {"level": level, "displacement": 0.01, "asymmetry": asymmetry}
    said = effect_by_key("joint", "hysteresis").statement(values, "m")
    assert said.endswith(f", and settles at {settled:.3g} N; add hysteresis to the simulator.")


def test_hysteresis_that_grows_without_end_is_said_to_and_stays_finite():
    values = {"level": 1.0, "displacement": 0.01, "asymmetry": -1.4}
    said = effect_by_key("joint", "hysteresis").statement(values)
    assert said.endswith(", and does not settle; add hysteresis to the simulator.")
    position = numbers(0.0, 1e6, -1e6, 1e-9)
    torch.testing.assert_close(resistance(position, 0.01, -1.4)[1:], numbers(-MOST, MOST, -MOST))
    followed = resistance(position, 0.01, torch.tensor(-1.4, dtype=torch.float64))  # without compiled code
    torch.testing.assert_close(followed, resistance(position, 0.01, -1.4))


@given(
    amplitude=st.floats(0.01, 2.0),
    displacement=st.floats(0.01, 1.0),
    samples=st.sampled_from([40, 41, 200]),
    asymmetry=st.floats(-1.0, 1.0),
)
def test_hysteresis_takes_energy_over_every_closed_cycle_and_never_passes_its_level(
    amplitude, displacement, samples, asymmetry
):
    angle = torch.linspace(0.0, 6.0 * math.pi, 3 * samples + 1, dtype=torch.float64)
    position = amplitude * torch.sin(angle)
    found = resistance(position, displacement, asymmetry)
    assert (found.abs() * (1.0 + asymmetry) <= math.hypot(1.0 + asymmetry, asymmetry) + 1e-12).all()
    work = 0.5 * (found[1:] + found[:-1]) * torch.diff(position)
    assert float(work[-samples:].sum()) < 0.0


@pytest.mark.parametrize("asymmetry", [-1.4, 0.0, 0.7])
def test_hysteresis_depends_on_the_way_and_not_on_the_speed(asymmetry):
    slow = 0.3 * torch.sin(torch.linspace(0.0, 9.0, 901, dtype=torch.float64))
    fast = resistance(slow, 0.1, asymmetry)
    torch.testing.assert_close(fast, resistance(slow.repeat_interleave(3), 0.1, asymmetry)[::3])
    turning = numbers(0.0, 0.3, -0.2, 0.1)
    between = numbers(0.0, 0.1, 0.3, 0.1, -0.2, 0.0, 0.1)
    torch.testing.assert_close(
        resistance(turning, 0.1, asymmetry), resistance(between, 0.1, asymmetry)[[0, 2, 4, 6]]
    )


@pytest.mark.parametrize("asymmetry", [-3.0, -1.375, -1.0, -0.999999, 0.0, 0.999999, 1.0, 3.0])
def test_hysteresis_is_the_same_compiled_and_sample_by_sample_with_finite_slopes(asymmetry):
    """At -1 loading is a line, at 1 unloading; where the axis rests nothing moves."""
    effect = effect_by_key("joint", "hysteresis")
    position = torch.cumsum(some_steps(80, seed=3).reshape(2, 40), 1)
    position[:, 10:15] = position[:, 10:11]
    values = {"level": 1.0, "displacement": 0.2, "asymmetry": asymmetry}
    symbols = {n: torch.tensor(v, dtype=torch.float64, requires_grad=True) for n, v in values.items()}
    compiled, slow = (
        effect.wrench(
            effect.along_time({"position": position}, each, constants("joint"), 0.01),
            each,
            constants("joint"),
        )["torque"]
        for each in (values, symbols)
    )
    torch.testing.assert_close(slow.detach(), compiled, rtol=1e-10, atol=1e-12)
    for slope in torch.autograd.grad(slow.square().sum(), list(symbols.values())):
        assert torch.isfinite(slope)
        assert float(slope) != 0.0


@given(ASYMMETRIES, st.integers(0, 999))
def test_hysteresis_moves_within_a_step_the_same_compiled_and_by_tensors(asymmetry, seed):
    effect = effect_by_key("joint", "hysteresis")
    signals = {
        "position": some_steps(20, seed),
        "hysteresis_position": some_steps(20, seed + 1),
        "hysteresis_deflection": 5.0 * some_steps(20, seed + 2),
    }
    values = {"level": 1.0, "displacement": 0.2, "asymmetry": asymmetry}
    tensors = {name: torch.tensor(value, dtype=torch.float64) for name, value in values.items()}
    compiled, slow = (
        effect.wrench(signals, each, constants("joint"))["torque"] for each in (values, tensors)
    )
    torch.testing.assert_close(compiled, slow, rtol=1e-9, atol=1e-12)


def test_hysteresis_leaves_its_operations_to_a_tracer():
    """A compiled loop would leave numbers, which a trace takes for constants."""
    effect, values = (
        effect_by_key("joint", "hysteresis"),
        {"level": 1.0, "displacement": 0.2, "asymmetry": 0.5},
    )

    def resistance(position: Tensor, before: Tensor) -> Tensor:
        signals = {"position": position, "hysteresis_position": before, "hysteresis_deflection": before}
        return effect.wrench(signals, values, constants("joint"))["torque"]

    with traced_operations():
        traced = make_fx(resistance)(some_steps(9, 0), some_steps(9, 1))
    here, before = some_steps(9, 2), some_steps(9, 3)
    torch.testing.assert_close(traced(here, before), resistance(here, before), rtol=1e-9, atol=1e-12)


def benchmark(samples: int, time_step: float) -> tuple[Tensor, Tensor]:
    """Return position (1, samples), m, and force of the hysteretic part, N, of a published mass on a spring.

    Noël & Schoukens 2016, Hysteretic benchmark with a dynamic nonlinearity, equations (1) to (3) and table 1.
    """
    alpha, beta, gamma, delta, mass, damping, stiffness = 5e4, 1e3, 0.8, -1.1, 2.0, 10.0, 5e4

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        x, v, z = state
        push = sum(60.0 * math.sin(2.0 * math.pi * f * time) for f in (7.0, 17.0, 26.0, 41.0))
        part = alpha * v - beta * (gamma * abs(v) * z + delta * v * abs(z))
        return np.array([v, (push - damping * v - stiffness * x - z) / mass, part])

    time = time_step * np.arange(samples)
    done = solve_ivp(rate, (0.0, time[-1]), np.zeros(3), t_eval=time, max_step=5e-4, rtol=1e-7, atol=1e-9)
    return torch.from_numpy(done.y[0][None]), torch.from_numpy(-done.y[2])


def test_the_published_numbers_of_a_hysteretic_benchmark_are_found_from_its_own_starts():
    position, force = benchmark(samples=2000, time_step=2.5e-4)
    effect, numbers_of_a_slide = (
        effect_by_key("joint", "hysteresis"),
        Simulator(JOINT, position_unit="m").constants(),
    )
    signals = {"position": position, "effort": force[None]}
    parameters = effect.parameters_in(signals)
    size = [parameter.default for parameter in parameters]

    def error(row: np.ndarray) -> np.ndarray:
        values = dict(zip((p.name for p in parameters), row.tolist(), strict=True))
        acted = effect.along_time(signals, values, numbers_of_a_slide, 2.5e-4)
        return (effect.wrench(acted, values, numbers_of_a_slide)["force"][0] - force).numpy()

    starts = [list(start.values()) for start in effect.starts_in(signals)]
    first = min(starts, key=lambda start: float(np.square(error(np.array(start))).sum()))
    bounds = [p.low for p in parameters], [p.high for p in parameters]
    found = least_squares(error, first, bounds=bounds, x_scale=size)
    size = math.hypot(1.0 - 1.375, -1.375)
    assert found.x == pytest.approx([62.5 / size, 1.25e-3 / size, -1.375], rel=0.01)
