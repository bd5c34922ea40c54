"""A quadrotor that is its own mirror image has to obey the mirrored law."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.effects import Effect, effect_by_key, effects_of
from tests.pipeline.effects.responses import assert_same, response
from tests.pipeline.platforms.machines import QUADROTOR, identity, signals_for

# A mirror turns round one component of what is a vector, and the two others of what turns.
POLAR = {"x": [-1.0, 1.0, 1.0], "y": [1.0, -1.0, 1.0]}
AXIAL = {axis: [-entry for entry in signs] for axis, signs in POLAR.items()}
EFFECT = pytest.mark.parametrize("effect", effects_of("quadrotor"), ids=identity)
AXIS = pytest.mark.parametrize("axis", ["x", "y"])


def opposite_rotors(axis: str) -> list[int]:
    """Return, for each rotor, the one in its place behind the mirror, which turns the other way round."""
    order = []
    for position, direction in zip(QUADROTOR.rotor_positions, QUADROTOR.rotor_directions, strict=True):
        mirrored = tuple(p * sign for p, sign in zip(position, POLAR[axis], strict=True))
        partner = QUADROTOR.rotor_positions.index(mirrored)
        assert QUADROTOR.rotor_directions[partner] == -direction
        order.append(partner)
    return order


def mirrored_signals(signals: dict[str, torch.Tensor], axis: str) -> dict[str, torch.Tensor]:
    polar, axial = (torch.tensor(signs[axis], dtype=torch.float64) for signs in (POLAR, AXIAL))
    whole = {
        "position": polar,
        "velocity": polar,
        "body_rate": axial,
        "attitude": torch.cat([torch.ones(1), axial]),
    }
    rotors = opposite_rotors(axis)
    return {
        name: series * whole[name]
        if name in whole
        else series[..., rotors]
        if name in ("rotor_speed", "motor_command")
        else series
        for name, series in signals.items()
    }


def mirrored_effect(effect: Effect, axis: str) -> Effect:
    """Return the effect that a mirror makes of it: another rotor's where it is of one rotor."""
    name, _, rotor = effect.key.partition("@")
    return (
        effect_by_key("quadrotor", f"{name}@{opposite_rotors(axis)[int(rotor) - 1] + 1}") if rotor else effect
    )


def mirrored_values(behind: Effect, values: dict[str, float], axis: str) -> dict[str, float]:
    """Return the values of the mirrored effect: what points along the mirrored axis, and a yaw torque, turn round."""
    if behind.name == "rotor_thrust_spread":
        excess = [*values.values(), -sum(values.values())]
        return {name: excess[rotor] for name, rotor in zip(values, opposite_rotors(axis), strict=False)}
    turned = (f"_{axis}", "imbalance")
    signs = [-1.0 if name.endswith(turned) else 1.0 for name in values]
    names = [parameter.name for parameter in behind.parameters]
    return {n: s * v for n, s, v in zip(names, signs, values.values(), strict=True)}


def balance_of(effect: Effect, values: dict[str, float], signals: dict[str, torch.Tensor]):
    """Return the sides of the balance, which are components of vectors; the readings of single rotors are none."""
    sides = response(effect, values, signals)
    return {name: value for name, value in sides.items() if not name.startswith("reading")}


@EFFECT
@AXIS
@given(seed=st.integers(0, 10**6))
@settings(max_examples=5)
def test_the_mirrored_state_feels_the_mirrored_wrench(effect, axis, seed):
    signals = signals_for(effect, (2, 40), seed)
    values, behind = effect.defaults(), mirrored_effect(effect, axis)
    expected = {}
    for name, value in balance_of(effect, values, signals).items():
        component = "xyz".index(name[-1])
        expected[name] = value * (AXIAL if "torque" in name else POLAR)[axis][component]
    found = balance_of(behind, mirrored_values(behind, values, axis), mirrored_signals(signals, axis))
    assert_same(found, expected, rtol=1e-9)
