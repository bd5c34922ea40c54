from dataclasses import replace
from pathlib import Path

import pytest
import torch
import yaml
from torch import Tensor

from simgap.effects import effect_by_key
from simgap.physics import batteries
from simgap.platforms import platform_from_config
from simgap.simulation import FittedEffect
from simgap.simulation.flight import Flight, racing_flight
from simgap.simulation.motion import QuadrotorMotion
from tests.pipeline.platforms.machines import QUADROTOR, some_signals

CONF = Path(__file__).parents[3] / "conf" / "platform"
PARTS = QuadrotorMotion.parts
EFFECTS = ("rotor_inertia_torque", "gyroscopic_torque", "body_drag", "rotor_drag")


def everything(**options) -> Flight:
    chosen = [effect_by_key("quadrotor", key) for key in EFFECTS]
    return racing_flight(
        QUADROTOR, tuple(FittedEffect(effect, effect.defaults()) for effect in chosen), **options
    )


def stiff(**options) -> Flight:
    """Return a flight whose battery stays at the nominal voltage."""
    flight = racing_flight(QUADROTOR, **options)
    (drive,) = flight.simulator.effects
    rested = float(batteries.open_circuit_voltage(torch.tensor(1.0, dtype=torch.float64)))
    constant = {"resistance": 0.0, "relaxation_resistance": 0.0, "capacity": 1e12, "cells": 14.8 / rested}
    held = replace(drive, values={**drive.values, **constant})
    return replace(flight, simulator=flight.simulator.with_effects((held,)))


def level(batch: int, dtype: torch.dtype = torch.float64) -> Tensor:
    state = torch.zeros(batch, 13, dtype=dtype)
    state[:, 3] = 1.0
    return state


def tumbling(batch: int, seed: int, dtype: torch.dtype = torch.float64) -> Tensor:
    return QuadrotorMotion().pack(some_signals("quadrotor", (batch,), seed, dtype))


def actions(batch: int, seed: int, dtype: torch.dtype = torch.float64) -> Tensor:
    random = torch.Generator().manual_seed(seed)
    draw = torch.rand(batch, 4, generator=random, dtype=torch.float64)
    return (draw * torch.tensor([25.0, 12.0, 12.0, 6.0]) - torch.tensor([0.0, 6.0, 6.0, 3.0])).to(dtype)


def flown(flight: Flight, state: Tensor, action: Tensor, periods: int) -> Tensor:
    memory = None
    for _ in range(periods):
        state, memory = flight.step(state, action, memory)
    return state


@pytest.mark.parametrize("integrator", ["euler", "rk4"])
def test_a_hovering_racer_stays_where_it_is(integrator):
    action = torch.tensor([[9.81, 0.0, 0.0, 0.0]], dtype=torch.float64)
    state = flown(stiff(integrator=integrator), level(1), action, 20)
    torch.testing.assert_close(state, level(1), atol=1e-6, rtol=0.0)


def test_a_racer_with_idling_rotors_falls_as_galilei_says():
    flight = stiff()
    state = flown(flight, level(1), torch.zeros(1, 4, dtype=torch.float64), 50)
    (drive,) = flight.simulator.effects
    idling = drive.effect.actuate(
        {"motor_command": torch.full((1, 4), flight.controller.idle, dtype=torch.float64)},
        drive.values,
        flight.simulator.constants(),
        None,
        0.002,
    )[0]["rotor_speed"]
    lift = QUADROTOR.thrust_coefficient * float(idling.square().sum()) / QUADROTOR.mass
    time, falling = 0.5, lift - QUADROTOR.gravity
    assert float(state[0, 2]) == pytest.approx(0.5 * falling * time**2, rel=1e-9)
    assert float(state[0, 9]) == pytest.approx(falling * time, rel=1e-9)
    assert lift < 0.02 * QUADROTOR.gravity


@pytest.mark.slow
@pytest.mark.parametrize(("name", "lag"), [("racer", 0.033), ("crazyflie_brushed", 0.07)])
def test_the_commanded_rates_are_reached(name, lag):
    config = yaml.safe_load((CONF / f"{name}.yaml").read_text(encoding="utf-8"))
    flight = racing_flight(platform_from_config(config), time_constant=lag)
    action = torch.tensor([[12.0, 2.0, -1.5, 0.5]], dtype=torch.float64)
    state = flown(flight, level(1), action, 60)
    assert state[0, PARTS["body_rate"]].tolist() == pytest.approx([2.0, -1.5, 0.5], rel=0.05)


def test_one_racer_alone_flies_as_in_a_crowd_of_ten_thousand():
    flight, batch = everything(substeps=2), 10_000
    initial, action = tumbling(batch, seed=1), actions(batch, seed=2)
    crowd = flown(flight, initial, action, 2)
    for index in (0, 4_321, batch - 1):
        alone = flown(flight, initial[index : index + 1], action[index : index + 1], 2)
        torch.testing.assert_close(alone, crowd[index : index + 1], rtol=1e-12, atol=1e-12)


def test_single_precision_follows_double():
    double = flown(everything(), tumbling(5, seed=3), actions(5, seed=4), 10)
    single = flown(
        everything(), tumbling(5, seed=3, dtype=torch.float32), actions(5, seed=4, dtype=torch.float32), 10
    )
    assert single.dtype == torch.float32
    torch.testing.assert_close(single.double(), double, rtol=1e-4, atol=1e-4)


def test_gradients_reach_through_a_rollout_as_finite_differences_say():
    initial = tumbling(1, seed=5)

    def end(action: Tensor, state: Tensor) -> Tensor:
        return flown(everything(substeps=1), state, action, 3)

    action = torch.tensor([[12.0, 1.0, -2.0, 0.5]], dtype=torch.float64)
    initial[:, PARTS["body_rate"]] *= 0.1
    assert torch.autograd.gradcheck(
        end, (action.requires_grad_(), initial.requires_grad_()), eps=1e-6, atol=1e-5, rtol=1e-4
    )


def test_gradients_reach_the_parameters_of_the_drive():
    flight = racing_flight(QUADROTOR)
    (drive,) = flight.simulator.effects

    def end(time_constant: Tensor, resistance: Tensor) -> Tensor:
        changed = replace(
            drive, values={**drive.values, "time_constant": time_constant, "resistance": resistance}
        )
        return flown(
            replace(flight, simulator=flight.simulator.with_effects((changed,))),
            level(1),
            actions(1, seed=6),
            3,
        )

    values = [torch.tensor(value, dtype=torch.float64, requires_grad=True) for value in (0.03, 0.012)]
    assert torch.autograd.gradcheck(end, values, eps=1e-6, atol=1e-5, rtol=1e-4)
