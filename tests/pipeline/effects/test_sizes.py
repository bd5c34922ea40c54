"""Starts and bounds of a joint's effects follow the recorded machine, in whatever units it is spoken of."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares
from torch import Tensor

from simgap.effects import Effect, effect_by_key, effects_of
from simgap.effects.sizes import POWERS, size_of, sizes_of
from simgap.platforms import Joint, JointMotor, Quadrotor, platform_from_config
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.platforms.machines import JOINT, QUADROTOR

ROOT = Path(__file__).parents[3]
TIME_STEP = 0.01  # s
LOAD = st.floats(-6.0, 6.0).map(lambda power: 10.0**power)
EFFECT = pytest.mark.parametrize("effect", effects_of("joint"), ids=lambda effect: effect.name)


def swung(effort: float = 1.0, travel: float = 1.0, driven: str = "effort") -> dict[str, Tensor]:
    """Return a recorded swing (2, 300) of an axis whose effort and travel are that many times as large."""
    time = TIME_STEP * torch.arange(300, dtype=torch.float64) + torch.tensor([[0.0], [1.7]])
    position = 0.6 * torch.sin(3.0 * time) + 0.2 * torch.sin(7.1 * time)
    velocity = 1.8 * torch.cos(3.0 * time) + 1.42 * torch.cos(7.1 * time)
    size = effort if driven == "effort" else 1.0
    signals = {"position": travel * position, "velocity": travel * velocity}
    return signals | {driven: size * 5.0 * torch.sin(4.0 * time), "battery_voltage": 12.0 + 0.1 * velocity}


def numbers_of(effort: float, travel: float, driven: str, position_unit: str) -> dict:
    """Return the constants of the same machine in other units; a volt and a second stay what they are."""
    motor = JointMotor(2.0 / (effort * travel), 0.03 / travel, 20.0) if driven == "voltage" else None
    platform = Joint(JOINT.inertia * effort / travel, 0.0, JOINT.stiffness * effort / travel, motor)
    return Simulator(platform, position_unit=position_unit).constants()


def factor_of(unit: str, effort: float, travel: float) -> float:
    """Return by what a number in a unit is multiplied where effort and travel are."""
    powers = {"effort": effort, "travel": travel, "speed": travel, "current": effort * travel}
    return size_of(unit, powers | {"resistance": 1.0 / (effort * travel)})


def cases() -> list:
    """Return each effect with each input on which it acts."""
    inputs = {"effort", "voltage"}
    pairs = [(effect, driven) for effect in effects_of("joint") for driven in sorted(inputs)]
    fitting = [(effect, driven) for effect, driven in pairs if {*effect.needs} & inputs <= {"effort", driven}]
    return [pytest.param(effect, driven, id=f"{effect.name}-{driven}") for effect, driven in fitting]


DRIVEN = pytest.mark.parametrize(("effect", "driven"), cases())


@DRIVEN
@settings(max_examples=10)
@given(effort=LOAD, travel=LOAD)
def test_starts_and_bounds_are_the_same_machine_s_in_any_units(effect, driven, effort, travel):
    first = (swung(driven=driven), numbers_of(1.0, 1.0, driven, "m"))
    other = (swung(effort, travel, driven), numbers_of(effort, travel, driven, "m"))
    factors = {p.name: factor_of(p.unit, effort, travel) for p in effect.parameters}
    starts = [{n: factors[n] * v for n, v in start.items()} for start in effect.starts_in(*first)]
    for expected, found in zip(starts, effect.starts_in(*other), strict=True):
        assert found == pytest.approx(expected, rel=1e-6)
    for expected, found in zip(effect.parameters_in(*first), effect.parameters_in(*other), strict=True):
        bounds = [factors[found.name] * getattr(expected, name) for name in ("default", "low", "high")]
        assert [found.default, found.low, found.high] == pytest.approx(bounds, rel=1e-6)


@DRIVEN
@pytest.mark.parametrize("position_unit", ["rad", "m"])
def test_every_start_lies_within_the_bounds(effect, driven, position_unit):
    recorded = swung(2e3, 1e-2, driven), numbers_of(2e3, 1e-2, driven, position_unit)
    bounds = {p.name: (p.low, p.high) for p in effect.parameters_in(*recorded)}
    for start in effect.starts_in(*recorded):
        assert start.keys() == bounds.keys()
        assert all(bounds[n][0] <= value <= bounds[n][1] for n, value in start.items()), start


@EFFECT
def test_the_unit_of_every_parameter_has_a_size_or_needs_none(effect):
    sizeless = {"1", "s", "V", "Hz", "1/K", "°C"}
    assert {parameter.unit for parameter in effect.parameters} <= POWERS.keys() | sizeless


def test_what_a_recording_does_not_show_has_no_size():
    assert sizes_of("quadrotor", swung(), {}) == {}
    silent = {name: torch.zeros_like(series) for name, series in swung().items()}
    assert sizes_of("joint", silent, {}) == {}
    assert sizes_of("joint", swung(driven="voltage"), {}).keys() == {"travel", "speed"}


@pytest.mark.parametrize("name", ["racer", "swerve_robot"])
def test_the_numbers_of_the_catalogue_hold_for_a_machine_of_its_platforms(name):
    platform = platform_from_config(yaml.safe_load((ROOT / f"conf/platform/{name}.yaml").read_text()))
    sizes = sizes_of(platform.kind, {}, Simulator(platform).constants())
    assert sizes == pytest.approx(dict.fromkeys(sizes, 1.0), rel=1e-3)


@settings(max_examples=20)
@given(length=LOAD, mass=LOAD, coefficient=LOAD)
def test_numbers_of_a_quadrotor_grow_with_the_machine(length, mass, coefficient):
    """Its arms are so many times as long, its mass and thrust so many times as great."""
    small, large = (
        Simulator(machine).constants() for machine in (QUADROTOR, larger(length, mass, coefficient))
    )
    turning = (mass / coefficient) ** 0.5
    expected = {
        "m": length,
        "m²": length**2,
        "N·s": mass * length,
        "kg·m²": mass * length / turning,
        "1/s": 1.0,
    }
    for unit, factor in expected.items():
        first, other = (size_of(unit, sizes_of("quadrotor", {}, numbers)) for numbers in (small, large))
        assert other / first == pytest.approx(factor, rel=1e-6)
    cable = effect_by_key("quadrotor", "slung_payload")
    assert cable.parameters_in({}, large)[1] == cable.parameters[1]


def larger(length: float, mass: float, coefficient: float) -> Quadrotor:
    """Return the quadrotor of the tests that many times as large."""
    positions = tuple(tuple(length * x for x in rotor) for rotor in QUADROTOR.rotor_positions)
    thrust = coefficient * QUADROTOR.thrust_coefficient
    return replace(
        QUADROTOR, mass=mass * QUADROTOR.mass, rotor_positions=positions, thrust_coefficient=thrust
    )


def test_near_a_resonance_the_effort_is_what_the_spring_and_the_inertia_take():
    """A sine of 1 rad at 10 rad/s on a spring, driven by a hundredth of what the spring holds."""
    angle = torch.linspace(0.0, 20.0 * torch.pi, 2001, dtype=torch.float64)[None, :-1]
    signals = {"position": angle.sin(), "velocity": 10.0 * angle.cos(), "effort": 2.0 * angle.cos()}
    rms = 0.5**0.5
    for stiffness in (0.0, 200.0):  # the inertia alone takes as much
        numbers = Simulator(Joint(2.0, 0.0, stiffness)).constants()
        assert sizes_of("joint", signals, numbers)["effort"] == pytest.approx(200.0 * rms, rel=1e-3)
    heavy = Simulator(Joint(1e-3, 50.0)).constants()
    expected = 50.0 * float(angle.sin().sin().square().mean().sqrt())
    assert sizes_of("joint", signals, heavy)["effort"] == pytest.approx(expected, rel=1e-6)
    light = Simulator(Joint(1e-3)).constants()
    assert sizes_of("joint", signals, light)["effort"] == pytest.approx(2.0 * rms, rel=1e-3)


def found_from_its_starts(
    effect: Effect, signals: dict[str, Tensor], torque: np.ndarray, numbers: dict
) -> dict:
    """Return the parameters with which a law comes nearest to a recorded torque, from its own starts and bounds."""
    parameters = effect.parameters_in(signals, numbers)
    low, high = ([getattr(parameter, name) for parameter in parameters] for name in ("low", "high"))

    def error(row: np.ndarray) -> np.ndarray:
        values = dict(zip((parameter.name for parameter in parameters), row.tolist(), strict=True))
        acted = effect.along_time(signals, values, numbers, TIME_STEP)
        return (effect.wrench(acted, values, numbers)["force"].numpy() - torque).ravel() / torque.std()

    starts = [list(start.values()) for start in effect.starts_in(signals, numbers)]
    starts.sort(key=lambda start: np.square(error(np.array(start))).sum())
    fits = [
        least_squares(error, start, bounds=(low, high), x_scale=[p.default for p in parameters])
        for start in starts[:2]
    ]
    best = min(fits, key=lambda fit: fit.cost)
    return dict(zip((parameter.name for parameter in parameters), best.x.tolist(), strict=True))


@pytest.mark.parametrize(
    ("level", "displacement", "asymmetry", "travel"),
    [
        (9.9e3, 4.4e-3, 0.2, 0.025),
        (9.9, 4.4, 0.2, 25.0),
        (2e-3, 3e-6, 0.0, 1e-3),
        (62.5, 1.25e-3, -1.375, 3e-3),
        (0.3, 0.2, 2.3, 1.0),
    ],
)
def test_hysteresis_is_found_from_its_own_starts_at_any_size(level, displacement, asymmetry, travel):
    """A damper in newtons and metres, the same in kilonewtons and millimetres, a finger, and uneven parts."""
    effect = effect_by_key("joint", "hysteresis")
    numbers = numbers_of(1.0, 1.0, "effort", "m")
    signals = swung(0.2 * level, travel)
    values = {"level": level, "displacement": displacement, "asymmetry": asymmetry}
    acted = Simulator(Joint(JOINT.inertia), (FittedEffect(effect, values),), "m").along_time(
        signals, TIME_STEP
    )
    torque = effect.wrench(acted, values, numbers)["force"].numpy()
    assert found_from_its_starts(effect, signals, torque, numbers) == pytest.approx(
        values, rel=1e-3, abs=1e-9
    )
