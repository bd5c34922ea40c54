"""Each law of a joint against what is known exactly of it."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Tensor

from simgap.effects import effect_by_key
from simgap.simulation import FittedEffect, Simulator, rollout
from tests.pipeline.effects.responses import constants, numbers
from tests.pipeline.platforms.machines import JOINT

FAST = st.floats(1.0, 20.0) | st.floats(-20.0, -1.0)


def torque(name: str, values: dict[str, float], **signals: Tensor) -> Tensor:
    still = torch.zeros_like(next(iter(signals.values())))
    everything = {"position": still, "velocity": still, "effort": still, **signals}
    return effect_by_key("joint", name).wrench(everything, values, constants("joint"))["torque"]


@given(velocity=FAST, level=st.floats(0.0, 10.0), fading=st.floats(0.1, 5.0))
def test_stribeck_friction_fades_as_a_bell_of_speed(velocity, level, fading):
    found = torque(
        "stribeck_friction", {"extra_level": level, "velocity": fading}, velocity=numbers(velocity)
    )
    expected = -math.copysign(level * math.exp(-((velocity / fading) ** 2)), velocity)
    assert float(found) == pytest.approx(expected, rel=1e-9, abs=1e-300)


def test_stribeck_friction_holds_what_is_applied_up_to_its_level():
    values = {"extra_level": 0.2, "velocity": 0.5}
    found = torque("stribeck_friction", values, effort=numbers(-0.5, -0.1, 0.1, 0.5))
    torch.testing.assert_close(found, numbers(0.2, 0.1, -0.1, -0.2))


@given(velocity=FAST, factor=st.floats(0.1, 10.0))
def test_quadratic_friction_grows_with_the_square_of_speed(velocity, factor):
    once = torque("quadratic_friction", {"coefficient": 0.3}, velocity=numbers(velocity))
    more = torque("quadratic_friction", {"coefficient": 0.3}, velocity=numbers(factor * velocity))
    assert float(more) == pytest.approx(factor**2 * float(once))


@pytest.mark.parametrize("difference", [-0.3, 0.3])
def test_asymmetric_friction_slows_one_direction_only_and_holds_only_against_it(difference):
    with_it, against_it = math.copysign(5.0, difference), math.copysign(5.0, -difference)
    values = {"difference": difference}
    moving = torque("asymmetric_friction", values, velocity=numbers(with_it, against_it))
    torch.testing.assert_close(moving, numbers(-difference, 0.0))
    at_rest = torque("asymmetric_friction", values, effort=numbers(0.2 * with_it, 0.2 * against_it))
    torch.testing.assert_close(at_rest, numbers(-difference, 0.0))


def test_on_an_axis_that_moves_asymmetry_is_half_a_load_and_half_coulomb_friction():
    velocity = numbers(-9.0, -2.0, 1.0, 4.0)
    difference = 0.3
    one_way = torque("asymmetric_friction", {"difference": difference}, velocity=velocity)
    both = torque("coulomb_friction", {"level": 0.5 * difference}, velocity=velocity)
    pull = torque("constant_load", {"load": -0.5 * difference}, velocity=velocity)
    torch.testing.assert_close(one_way, both + pull)


@given(velocity=FAST, effort=st.floats(-10.0, 10.0), ratio=st.floats(0.0, 1.0))
def test_a_gear_loses_a_share_of_what_it_transmits_and_never_more(velocity, effort, ratio):
    values = {"ratio": ratio}
    found = float(
        torque("load_dependent_friction", values, velocity=numbers(velocity), effort=numbers(effort))
    )
    assert found == pytest.approx(-ratio * abs(effort) * math.copysign(1.0, velocity))
    at_rest = float(torque("load_dependent_friction", values, effort=numbers(effort)))
    assert at_rest == pytest.approx(-ratio * effort)


@pytest.mark.parametrize(
    ("name", "values", "potential"),
    [
        ("linear_stiffness", {"stiffness": 0.7}, lambda q: 0.35 * q**2),
        ("cubic_stiffness", {"stiffness": 0.7}, lambda q: 0.175 * q**4),
        ("gravity_load", {"sine": 0.5, "cosine": -0.2}, lambda q: -0.5 * q.cos() - 0.2 * q.sin()),
        (
            "cogging",
            {"sine": 0.06, "cosine": 0.02, "cycles": 9.0},
            lambda q: (0.06 * (9.0 * q).cos() - 0.02 * (9.0 * q).sin()) / 9.0,
        ),
        ("constant_load", {"load": 0.3}, lambda q: -0.3 * q),
    ],
)
def test_what_depends_on_the_place_alone_is_the_slope_of_a_potential(name, values, potential):
    position = torch.linspace(-4.0, 4.0, 41, dtype=torch.float64, requires_grad=True)
    (slope,) = torch.autograd.grad(potential(position).sum(), position)
    torch.testing.assert_close(torque(name, values, position=position.detach()), -slope)


def test_cogging_comes_back_after_a_cycle():
    position = torch.linspace(-1.0, 1.0, 21, dtype=torch.float64)
    values = {"sine": 0.06, "cosine": 0.02, "cycles": 7.0}
    once = torque("cogging", values, position=position)
    again = torque("cogging", values, position=position + 2.0 * math.pi / 7.0)
    torch.testing.assert_close(once, again)


def test_a_slide_has_no_weight_that_turns():
    effect = effect_by_key("joint", "gravity_load")
    numbers_of_a_slide = Simulator(JOINT, position_unit="m").constants()
    position = numbers(-1.0, 0.5)
    assert effect.wrench({"position": position}, effect.defaults(), numbers_of_a_slide).keys() == {"force"}
    assert not effect.wrench({"position": position}, effect.defaults(), numbers_of_a_slide)["force"].any()


@given(command=st.floats(-20.0, 20.0), width=st.floats(0.0, 10.0))
def test_a_dead_zone_passes_nothing_inside_and_less_outside(command, width):
    effect, numbers_of_motor = effect_by_key("joint", "dead_zone"), constants("joint")
    expected = math.copysign(max(abs(command) - width, 0.0), command)
    found, _ = effect.actuate({"effort": numbers(command)}, {"width": width}, numbers_of_motor, None, 0.01)
    assert float(found["effort"]) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(("volts", "left"), [(9.0, 6.0), (3.1, 0.1), (2.9, 0.0), (-4.0, -1.0)])
def test_a_dead_zone_is_as_wide_as_the_effort_that_its_voltage_gives_at_standstill(volts, left):
    """3 V at 0.6 N·m/A and 2 Ω are 0.9 N·m."""
    signals = {"voltage": numbers(volts), "position": numbers(0.0), "velocity": numbers(0.0)}
    dead = Simulator(JOINT, (FittedEffect(effect_by_key("joint", "dead_zone"), {"width": 0.9}),))
    found = dead.along_time({name: series[None] for name, series in signals.items()}, 0.01)
    assert found["voltage"].item() == pytest.approx(left, abs=1e-12)
    assert found["effort"].item() == pytest.approx(left * 0.3, abs=1e-12)


@pytest.mark.parametrize(("position_unit", "unit"), [("rad", "N·m"), ("m", "N")])
def test_a_dead_zone_is_stated_as_an_effort_whatever_the_command_is(position_unit, unit):
    effect = effect_by_key("joint", "dead_zone")
    assert effect.units(position_unit) == {"width": unit}
    assert f"below 0.9 {unit} at standstill" in effect.statement({"width": 0.9}, position_unit)


def test_a_sagging_supply_gives_the_effort_of_the_voltage_that_it_leaves():
    sag = effect_by_key("joint", "battery_sag")
    simulator = Simulator(JOINT, (FittedEffect(sag, {"share": 1.0, "nominal_voltage": 12.0}),))
    signals = {"position": numbers(0.0, 0.1), "velocity": numbers(2.0, -3.0), "voltage": numbers(10.0, -6.0)}
    sagging = {name: value[None] for name, value in signals.items()} | {
        "battery_voltage": numbers(9.0, 6.0)[None]
    }
    lower = {name: value[None] for name, value in signals.items()} | {"voltage": numbers(7.5, -3.0)[None]}
    found = simulator.along_time(sagging, 0.01)
    expected = Simulator(JOINT).along_time(lower, 0.01)
    torch.testing.assert_close(found["effort"], expected["effort"])
    torch.testing.assert_close(found["voltage"], expected["voltage"])


def test_a_motor_loses_its_coefficient_for_each_kelvin_above_its_reference():
    effect = effect_by_key("joint", "temperature_derating")
    signals = {"effort": numbers(1.0, 1.0, -2.0), "temperature": numbers(25.0, 75.0, 75.0)}
    values = {"coefficient": 0.002, "reference": 25.0}
    found, _ = effect.actuate(signals, values, constants("joint"), None, 0.01)
    torch.testing.assert_close(found["effort"], numbers(1.0, 0.9, -1.8))


def test_a_warm_motor_under_a_voltage_has_more_resistance_and_weaker_magnets():
    """By Ohm's and Faraday's laws: K·(1 − 0.0012·δ) and R·(1 + 0.0039·δ) for δ kelvin, to the first order."""
    effect, warmer = effect_by_key("joint", "temperature_derating"), 0.1
    values = {"coefficient": 0.0051, "reference": 25.0, "magnets_share": 0.0012 / 0.0051}
    motion = {"position": numbers(0.0, 0.1), "velocity": numbers(2.0, -3.0), "voltage": numbers(10.0, 6.0)}
    signals = {name: value[None] for name, value in motion.items()} | {
        "temperature": numbers(*[25.0 + warmer] * 2)[None]
    }
    found = Simulator(JOINT, (FittedEffect(effect, values),)).along_time(signals, 0.01)["effort"]
    cold = constants("joint")
    resistance = cold["resistance"] * (1.0 + 0.0039 * warmer)
    constant = cold["torque_constant"] * cold["gear_ratio"] * (1.0 - 0.0012 * warmer)
    expected = constant * (signals["voltage"] - constant * signals["velocity"]) / resistance
    torch.testing.assert_close(found, expected, rtol=1e-6, atol=0.0)


def test_current_rises_with_the_time_constant_of_the_winding():
    """After a step of the voltage the mean over each time step is that of 1 − e^(−t/τ)."""
    effect, time_step, lag = effect_by_key("joint", "motor_inductance"), 0.002, 0.005
    effort = torch.cat([torch.zeros(1, 1), torch.ones(1, 20)], dim=1).double()
    values = {"inductance": lag * constants("joint")["resistance"]}
    found = effect.along_time({"effort": effort}, values, constants("joint"), time_step)["effort"][0, 1:]
    start = time_step * torch.arange(20, dtype=torch.float64)
    left = lag / time_step * (torch.exp(-start / lag) - torch.exp(-(start + time_step) / lag))
    torch.testing.assert_close(found, 1.0 - left)


@given(offset=st.integers(-8, 8))
def test_a_time_offset_moves_the_command_to_the_clock_of_the_state(offset):
    effect = effect_by_key("joint", "sensor_time_offset")
    time = torch.arange(50, dtype=torch.float64)[None]
    signals = {"voltage": torch.sin(time), "position": torch.cos(time), "velocity": torch.sin(2.0 * time)}
    undone = effect.undo(signals, {"offset": offset * 0.01}, 0.01)
    torch.testing.assert_close(undone["voltage"][:, 10:40], signals["voltage"][:, 10 - offset : 40 - offset])
    assert torch.equal(undone["position"], signals["position"])


def through_play(effort: Tensor, velocity: Tensor, share: float = 0.25, gap: float = 0.1) -> Tensor:
    """Return what reaches a recorded axis (samples,) that is driven through a gap, at 1 kHz."""
    effect = effect_by_key("joint", "backlash")
    signals = {"effort": effort[None], "velocity": velocity[None]}
    values = {"gap": gap, "motor_inertia_share": share}
    return effect.along_time(signals, values, constants("joint"), 1e-3)["effort"][0]


def test_backlash_transmits_nothing_inside_the_gap_and_hands_over_what_was_gathered_there():
    """After a reversal of the effort on a held axis, the crossing takes √(2·gap·J/effort)."""
    effort = torch.ones(300, dtype=torch.float64)
    effort[100:] = -0.5
    found = through_play(effort, torch.zeros(300, dtype=torch.float64))
    inertia = 0.25 * JOINT.inertia
    crossing = round(1e3 * math.sqrt(2.0 * 0.1 * inertia / 0.5))
    torch.testing.assert_close(found[:100], effort[:100])
    torch.testing.assert_close(
        found[100 : 100 + crossing - 2], torch.zeros(crossing - 2).double(), atol=1e-12, rtol=0
    )
    torch.testing.assert_close(found[100 + crossing + 3 :], effort[100 + crossing + 3 :])
    assert float(found.sum()) == pytest.approx(float(effort.sum()))


def test_in_the_gap_the_axis_moves_as_if_the_motor_were_not_there():
    """Its own part of the inertia and its own load decide, whatever the effort."""
    effect = effect_by_key("joint", "backlash")
    values = {"gap": 1.0, "motor_inertia_share": 0.25}
    load = effect_by_key("joint", "constant_load")
    alone = (FittedEffect(effect, values), FittedEffect(load, {"load": 0.05}))
    platform = type(JOINT)(inertia=JOINT.inertia)
    effort = torch.cat(
        [torch.full((2, 1), 1e-3), torch.tensor([[-0.01], [-0.03]]).expand(2, 99)], dim=1
    ).double()
    simulator = Simulator(platform, alone)
    states = rollout(simulator, torch.zeros(2, 2, dtype=torch.float64), {"effort": effort}, 1e-3)
    acceleration = (states[:, 80, 1] - states[:, 40, 1]) / 0.04
    expected = torch.full((2,), 0.05 / (0.75 * JOINT.inertia), dtype=torch.float64)
    torch.testing.assert_close(acceleration, expected, rtol=1e-6, atol=0)


@pytest.mark.parametrize("pitch", [0.4, 0.1, 0.024, 0.01])
def test_some_start_of_cogging_is_within_a_quarter_wave_of_any_pitch_along_a_short_travel(pitch):
    """A stage of 0.4 m: at the ends of its travel the start and the ripple are less than a quarter wave apart."""
    position = torch.linspace(-0.2, 0.2, 101, dtype=torch.float64)[None]
    cogging = effect_by_key("joint", "cogging")
    starts = cogging.starts_in({"position": position})
    apart = min(abs(start["cycles"] - 2.0 * math.pi / pitch) for start in starts)
    assert apart * 0.2 <= 0.25 * math.pi + 1e-9
    assert all(p.low <= start[p.name] <= p.high for start in starts for p in cogging.parameters)


def test_an_axis_that_turns_far_starts_from_whole_numbers_of_cogs():
    position = torch.linspace(-1.0, 1.0, 101, dtype=torch.float64)[None]
    cogging = effect_by_key("joint", "cogging")
    assert cogging.starts_in({"position": position}) == cogging.starts()
