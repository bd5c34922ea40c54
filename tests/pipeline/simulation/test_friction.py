"""What dry friction holds at standstill: all that acts, and once, however many effects hold."""

import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.effects import DryFriction, effect_by_key, effects_of
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.platforms.machines import JOINT, SWERVE, some_signals

COULOMB = {"level": 0.2}
STRIBECK = {"extra_level": 0.3, "velocity": 0.5}


def simulator(platform, **effects) -> Simulator:
    return Simulator(
        platform, tuple(FittedEffect(effect_by_key(platform.kind, k), v) for k, v in effects.items())
    )


def at_rest(effort: float, position: float = 0.0) -> dict[str, torch.Tensor]:
    return {
        "position": torch.tensor([position], dtype=torch.float64),
        "velocity": torch.zeros(1).double(),
        "effort": torch.tensor([effort], dtype=torch.float64),
    }


def wrench_on(joint: Simulator, effort: float, position: float = 0.0) -> float:
    return float(joint.wrench(at_rest(effort, position), joint.constants())["torque"])


@given(effort=st.floats(-1.0, 1.0))
@settings(max_examples=30)
def test_two_frictions_hold_what_one_of_both_levels_does(effort):
    both = simulator(JOINT, coulomb_friction=COULOMB, stribeck_friction=STRIBECK)
    one = simulator(JOINT, coulomb_friction={"level": 0.5})
    assert wrench_on(both, effort) == pytest.approx(wrench_on(one, effort), abs=1e-12)
    assert abs(wrench_on(both, effort)) == pytest.approx(max(abs(effort) - 0.5, 0.0), abs=1e-12)


def test_friction_holds_what_other_effects_do():
    pulled = simulator(JOINT, gravity_load={"sine": 0.1, "cosine": 0.05}, constant_load={"load": -0.1})
    held = simulator(
        JOINT,
        coulomb_friction=COULOMB,
        gravity_load={"sine": 0.1, "cosine": 0.05},
        constant_load={"load": -0.1},
    )
    assert wrench_on(pulled, 0.0) != 0.0
    assert wrench_on(held, 0.0) == pytest.approx(0.0, abs=1e-12)
    beyond = wrench_on(pulled, 1.0)
    assert wrench_on(held, 1.0) == pytest.approx(beyond - 0.2)


@pytest.mark.parametrize(("group", "channel"), [("drive", "drive_x"), ("steer", "steer_2")])
def test_wheels_and_modules_are_held_once(group, channel):
    names = {f"coulomb_friction@{group}": {"level": 2.0}, f"stribeck_friction@{group}": STRIBECK}
    signals = {name: torch.zeros_like(s) for name, s in some_signals("swerve", (3,), seed=0).items()}
    signals["drive_torque"] = torch.full((3, 4), 1.5).double()
    signals["steer_voltage"] = torch.full((3, 4), 0.2).double()
    free, held = Simulator(SWERVE), simulator(SWERVE, **names)
    signals = {**free.mechanism.actuate(signals, free.constants()), "drive_torque": signals["drive_torque"]}
    assert float(free.wrench(signals, free.constants())[channel].abs().min()) > 0.0
    rest = held.wrench(signals, held.constants())[channel]
    torch.testing.assert_close(rest, torch.zeros_like(rest), rtol=0.0, atol=1e-9)


def test_a_linear_effect_is_none_where_friction_holds_against_it():
    load, viscous = effect_by_key("joint", "constant_load"), effect_by_key("swerve", "viscous_friction@drive")
    assert Simulator(JOINT).is_linear_in(load)
    assert not simulator(JOINT, coulomb_friction=COULOMB).is_linear_in(load)
    assert simulator(SWERVE, **{"coulomb_friction@steer": {"level": 1.0}}).is_linear_in(viscous)


@pytest.mark.parametrize("kind", ["joint", "swerve"])
def test_what_a_friction_holds_is_known_to_the_mechanism(kind):
    machine = Simulator(JOINT if kind == "joint" else SWERVE)
    signals = some_signals(kind, (5,), seed=0)
    signals = machine.mechanism.actuate(signals, machine.constants())
    loads = machine.mechanism.loads(machine.wrench(signals, machine.constants()), signals)
    holding = [effect for effect in effects_of(kind) if isinstance(effect, DryFriction)]
    assert holding
    assert {effect.holds for effect in holding} == loads.keys()
