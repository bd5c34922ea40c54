"""Laws of healthy rotors that differ from the platform file or from each other."""

from dataclasses import replace

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.effects.responses import TIME_STEP, assert_same, constants
from tests.pipeline.effects.rotors import HOVER, SEED, hovering, of
from tests.pipeline.platforms.machines import QUADROTOR, some_signals


def _fitted(key: str, **values: float) -> FittedEffect:
    return FittedEffect(of(key), values)


def test_a_scaled_command_scales_thrust_and_reaction_torque_with_its_square():
    command = {"motor_command": some_signals("quadrotor", (5,), seed=6)["motor_command"]}
    ratio = 1.06
    scale, thrust, torque = (
        FittedEffect(of(f"{name}_error"), {"ratio": value})
        for name, value in (
            ("command_scale", ratio),
            ("thrust_coefficient", ratio**2),
            ("torque_coefficient", ratio**2),
        )
    )
    mechanisms = [Simulator(QUADROTOR, effects) for effects in ((scale,), (thrust, torque))]
    found, expected = (
        each.mechanism.wrench(each.mechanism.actuate(command, each.constants()), each.constants())
        for each in mechanisms
    )
    assert_same(found, expected)


def test_recorded_speeds_show_the_scale_of_a_command_and_nothing_else():
    signals = {name: series[None] for name, series in some_signals("quadrotor", (5,), seed=7).items()}
    plain, scaled = Simulator(QUADROTOR), Simulator(QUADROTOR, (_fitted("command_scale_error", ratio=1.1),))
    acting = [each.along_time(signals, TIME_STEP) for each in (plain, scaled)]
    assert_same(plain.balance(acting[0]).wrench, scaled.balance(acting[1]).wrench)
    torch.testing.assert_close(acting[1]["commanded_rotor_speed"], 1.1 * acting[0]["commanded_rotor_speed"])


def test_a_yaw_trim_is_a_torque_coefficient_for_each_direction():
    """Pairs of 1.07 and 0.93 times the nominal coefficient, as a platform file may give them."""
    signals = some_signals("quadrotor", (5,), seed=8)
    ratios = tuple(1.0 + 0.07 * direction for direction in QUADROTOR.rotor_directions)
    pairs = Simulator(replace(QUADROTOR, torque_ratios=ratios)).balance(signals).wrench
    trim = Simulator(QUADROTOR, (_fitted("yaw_trim", imbalance=0.07),)).balance(signals).wrench
    assert_same(trim, pairs)


def test_a_trimmed_machine_hovers_level_with_one_pair_faster():
    """Squared speeds of direction −1 are above the mean by the imbalance, and those of direction +1 below."""
    squares = torch.tensor([1.0 - 0.07 * d for d in QUADROTOR.rotor_directions], dtype=torch.float64)
    signals = hovering(1) | {"rotor_speed": HOVER * squares.sqrt().expand(1, 1, 4)}
    wrench = Simulator(QUADROTOR, (_fitted("yaw_trim", imbalance=0.07),)).balance(signals).wrench
    assert float(wrench["force_z"]) == pytest.approx(QUADROTOR.gravity)
    for axis in "xyz":
        assert float(wrench[f"torque_{axis}"].abs()) < 1e-12


@given(seed=SEED, first=st.tuples(*[st.floats(-0.1, 0.1)] * 3))
def test_a_spread_is_a_coefficient_for_each_rotor(seed, first):
    signals = some_signals("quadrotor", (5,), seed)
    excess = (*first, -sum(first))
    ratios = tuple(1.0 + entry for entry in excess)
    uneven = Simulator(replace(QUADROTOR, thrust_ratios=ratios, torque_ratios=ratios)).balance(signals).wrench
    values = {f"excess_{rotor}": entry for rotor, entry in enumerate(first, 1)}
    spread = Simulator(QUADROTOR, (_fitted("rotor_thrust_spread", **values),)).balance(signals).wrench
    assert_same(spread, uneven, rtol=1e-9)


def test_more_thrust_on_one_side_turns_as_a_centre_of_mass_off_the_middle_does():
    signals = some_signals("quadrotor", (50,), seed=9)
    values = {"excess_1": 0.04, "excess_2": -0.04, "excess_3": -0.04}  # front against back
    forward = -0.04 * QUADROTOR.rotor_positions[0][0]
    numbers = constants("quadrotor")
    spread = of("rotor_thrust_spread").wrench(signals, values, numbers)
    offset = {"offset_x": forward, "offset_y": 0.0}
    centre = of("center_of_mass_offset").wrench(signals, offset, numbers)
    torch.testing.assert_close(spread["torque_y"], centre["torque_y"])
    hover = {"rotor_speed": torch.full((4,), HOVER, dtype=torch.float64)}
    for channel in ("force_z", "torque_x", "torque_z"):  # the terms that tell them apart vanish in hover
        assert float(spread[channel].abs().max()) > 0.0
        assert float(of("rotor_thrust_spread").wrench(hover, values, numbers)[channel].abs()) < 1e-12


def test_a_fault_and_a_centre_of_mass_go_with_the_thrust_that_each_rotor_has():
    signals = some_signals("quadrotor", (5,), seed=10)
    uneven = replace(QUADROTOR, thrust_ratios=(0.9, 1.1, 0.9, 1.1))
    fault = Simulator(uneven, (_fitted("rotor_fault@2", loss_2=1.0),)).balance(signals).wrench
    offset = Simulator(uneven, (_fitted("center_of_mass_offset", offset_x=0.01, offset_y=0.0),)).balance(
        signals
    )
    plain = Simulator(uneven).balance(signals).wrench
    lift = QUADROTOR.mass * plain["force_z"]
    torch.testing.assert_close(offset.wrench["torque_y"] - plain["torque_y"], 0.01 * lift)
    signals["rotor_speed"][..., 1] = 0.0
    assert_same(fault, Simulator(uneven).balance(signals).wrench)
