"""What acts behind a position command: the servo's loop, and the effects in and around it."""

import math
from dataclasses import replace

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.effects import effect_by_key, effects_of
from simgap.errors import InputError
from simgap.gap.candidates import candidates_for
from simgap.platforms import Controller
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.blocks import Blocks
from simgap.simulation.replay import replay
from tests.pipeline.platforms.machines import SERVO

STEP = 0.01


def numbers(*values: float) -> torch.Tensor:
    return torch.tensor([values], dtype=torch.float64)


def signals(command: torch.Tensor, position: float = 0.0, velocity: float = 0.0) -> dict[str, torch.Tensor]:
    still = torch.ones_like(command)
    return {"position": position * still, "velocity": velocity * still, "position_command": command}


def servo(name: str = "", controller: Controller | None = SERVO.controller, **values: float) -> Simulator:
    effects = (FittedEffect(effect_by_key("joint", name), values),) if name else ()
    return Simulator(replace(SERVO, controller=controller), effects)


def effort_of(simulator: Simulator, acting: dict[str, torch.Tensor]) -> torch.Tensor:
    return simulator.along_time(acting, STEP)["effort"][0]


@given(command=st.floats(-2, 2), position=st.floats(-2, 2), velocity=st.floats(-5, 5))
def test_the_loop_is_proportional_and_derivative_and_limited(command, position, velocity):
    expected = min(max(9.0 * (command - position) - 0.5 * velocity, -4.0), 4.0)
    found = effort_of(servo(), signals(numbers(command), position, velocity))
    assert found.item() == pytest.approx(expected, abs=1e-12)


def test_a_free_loop_swings_as_a_second_order_system():
    """Åström & Murray 2008, Feedback systems, table 6.1: the step response below critical damping."""
    free = replace(SERVO, gravity_torque=0.0, stiffness=0.0, controller=Controller(9.0, 0.5))
    command = torch.ones(1, 100, dtype=torch.float64)
    states = rollout(
        Simulator(free), torch.zeros(1, 2, dtype=torch.float64), {"position_command": command}, STEP
    )
    frequency, ratio = math.sqrt(9.0 / 0.02), 0.5 / (2.0 * math.sqrt(9.0 * 0.02))
    damped = frequency * math.sqrt(1.0 - ratio**2)
    time = torch.arange(101, dtype=torch.float64) * STEP
    swing = torch.cos(damped * time) + ratio * frequency / damped * torch.sin(damped * time)
    expected = 1.0 - torch.exp(-ratio * frequency * time) * swing
    torch.testing.assert_close(states[0, :, 0], expected, rtol=0.0, atol=2e-3)


def test_a_servo_without_gains_says_so_in_one_line():
    with pytest.raises(InputError, match=r"platform.controller.*give proportional and derivative"):
        effort_of(servo(controller=None), signals(numbers(1.0)))


@pytest.mark.parametrize(
    ("name", "values", "expected"),
    [
        ("effort_limit", {"limit": 1.0}, 1.0),
        ("effort_limit", {"limit": 1e4}, 2.7),
        ("controller_gain_error", {"proportional": 1.2, "derivative": 0.5}, 1.2 * 2.7),
        ("dead_zone", {"width": 0.9}, 1.8),
        ("dead_zone", {"width": 3.0}, 0.0),
        ("input_scale_error", {"ratio": 0.5}, 1.35),
    ],
)
def test_effects_of_a_servo_at_rest_that_is_told_to_go_on(name, values, expected):
    """At an error of 0.3 rad and 9 N·m/rad the nominal loop gives 2.7 N·m."""
    assert effort_of(servo(name, **values), signals(numbers(0.3))).item() == pytest.approx(
        expected, abs=1e-12
    )


def test_a_dead_zone_is_one_of_the_error_and_not_of_the_place():
    found = effort_of(servo("dead_zone", width=0.9), signals(numbers(1.3), position=1.0))
    assert found.item() == pytest.approx(1.8, abs=1e-12)


def test_a_late_command_leaves_the_feedback_as_it_is():
    command = torch.linspace(0.0, 0.4, 41, dtype=torch.float64)[None]
    late = servo("command_delay", delay=0.03).along_time(signals(command, velocity=0.2), STEP)
    expected = 9.0 * (command[0, :-3]) - 0.5 * 0.2
    torch.testing.assert_close(late["effort"][0, 3:], expected)


def test_a_lag_is_one_of_the_effort():
    step = torch.cat([torch.zeros(1, 1), 0.1 * torch.ones(1, 60)], 1).double()
    lagged = effort_of(servo("motor_lag", time_constant=0.05), signals(step))
    time = (torch.arange(60, dtype=torch.float64) + 0.5) * STEP
    torch.testing.assert_close(lagged[1:], 0.9 * (1.0 - torch.exp(-time / 0.05)), rtol=0.0, atol=3e-3)


@pytest.mark.parametrize("given_gain", ["proportional", "derivative"])
def test_only_a_gain_that_was_given_can_be_wrong(given_gain):
    known = Controller(9.0, 0.5, **{f"{given_gain}_std": None})
    other = "derivative" if given_gain == "proportional" else "proportional"
    simulator = servo(
        "controller_gain_error", replace(known, **{f"{other}_std": 0.1}), proportional=2.0, derivative=2.0
    )
    constants = simulator.constants()
    assert constants[given_gain] == 2.0 * getattr(known, given_gain)
    assert constants[other] == getattr(known, other)


def test_what_may_be_missing_behind_a_position_command():
    acting = signals(numbers(0.1)) | {"elapsed": numbers(0.0)}
    found = {effect.name for effect in candidates_for(servo(), acting, None)}
    assert {
        "controller_gain_error",
        "effort_limit",
        "command_delay",
        "motor_lag",
        "dead_zone",
        "backlash",
    } <= found
    assert {"coulomb_friction", "viscous_friction", "gravity_load", "constant_load"} <= found
    assert found.isdisjoint({"battery_sag", "current_limit", "motor_constant_error", "motor_inductance"})
    unknown = servo(controller=Controller(9.0, 0.5, None, 0.1, 0.1))
    assert "controller_gain_error" not in {e.name for e in candidates_for(unknown, acting, None)}
    derived = acting | {"derived_velocity": numbers(1.0)}
    gone = found - {effect.name for effect in candidates_for(servo(), derived, None)}
    assert gone == {"velocity_filter"}
    told_nothing = {name: series for name, series in acting.items() if name != "position_command"}
    driven = candidates_for(servo(), told_nothing | {"effort": numbers(0.0)}, None)
    assert {"controller_gain_error", "effort_limit"}.isdisjoint(effect.name for effect in driven)


@pytest.mark.parametrize(
    "name",
    sorted(
        effect.key
        for effect in effects_of("joint")
        if not {"voltage", "temperature"} & {*effect.needs}
        and effect.key not in ("velocity_filter", "sensor_time_offset")
    ),
)
def test_a_recording_is_replayed_as_it_was_simulated_with_every_effect(name):
    """The loop is closed over the simulated motion, whatever acts in it."""
    effect = effect_by_key("joint", name)
    simulator = servo(name, **effect.defaults())
    time = torch.arange(60, dtype=torch.float64) * STEP
    command = 0.6 * torch.sin(torch.tensor([[4.0], [7.0]], dtype=torch.float64) * time)
    states = rollout(simulator, torch.zeros(2, 2, dtype=torch.float64), {"position_command": command}, STEP)[
        :, :-1
    ]
    acting = {"position": states[..., 0], "velocity": states[..., 1]}
    blocks = Blocks(
        signals=acting | {"position_command": command},
        run=torch.arange(2),
        runs=("one", "two"),
        start=torch.zeros(2, dtype=torch.float64),
        time_step=STEP,
        margin=20,
        samples=20,
        held_commands={"position_command": command},
    )
    again = replay(simulator, blocks, states[:, 20], 15)
    slack = 1e-9 if not getattr(effect, "remembers", False) else 0.05  # a memory begins anew in the margin
    torch.testing.assert_close(again, states[:, 20:36], rtol=0.0, atol=slack)
