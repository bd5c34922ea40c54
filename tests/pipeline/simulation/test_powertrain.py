import itertools
import math
from dataclasses import replace

import pytest
import torch

from simgap.physics import batteries
from simgap.simulation.powertrain import Powertrain, powertrain_values
from tests.pipeline.platforms.machines import QUADROTOR

DT = 0.002
CONSTANTS = {"torque_coefficient": QUADROTOR.torque_coefficient}
HOVER = QUADROTOR.hover_rotor_speed / QUADROTOR.motor_speed_max


def stiff(**changes: float) -> dict:
    """Return values of a battery that stays at the nominal voltage."""
    values = {
        **powertrain_values(QUADROTOR),
        "resistance": 0.0,
        "relaxation_resistance": 0.0,
        "capacity": 1e12,
    }
    rested = float(batteries.open_circuit_voltage(torch.tensor(1.0, dtype=torch.float64)))
    return {**values, "cells": QUADROTOR.nominal_voltage / rested, **changes}


def driven(values: dict, throttles: torch.Tensor) -> list[tuple[dict, dict]]:
    memory, seen = None, []
    for throttle in throttles:
        out, memory = Powertrain().actuate({"motor_command": throttle}, values, CONSTANTS, memory, DT)
        seen.append((out, memory))
    return seen


def test_hover_and_full_throttle_are_the_platforms():
    throttle = torch.tensor([[HOVER] * 4, [1.0] * 4], dtype=torch.float64).expand(5, 2, 4)
    out, _ = driven(stiff(), throttle)[-1]
    speeds = [QUADROTOR.hover_rotor_speed, QUADROTOR.motor_speed_max]
    assert out["rotor_speed"][:, 0].tolist() == pytest.approx(speeds, rel=1e-9)
    assert out["battery_voltage"].tolist() == pytest.approx([14.8, 14.8])


def test_speed_follows_a_step_of_the_throttle_with_the_time_constant():
    throttle = torch.full((51, 1, 4), 1.0, dtype=torch.float64)
    throttle[0] = HOVER
    _, memory = driven(stiff(time_constant=0.05), throttle)[-1]
    start, end = QUADROTOR.hover_rotor_speed, QUADROTOR.motor_speed_max
    exact = end + (start - end) * math.exp(-50 * DT / 0.05)
    assert memory["speed"][0].tolist() == pytest.approx([exact] * 4, rel=1e-9)


def test_what_acts_is_the_mean_speed_over_the_step():
    throttle = torch.full((2, 1, 4), 1.0, dtype=torch.float64)
    throttle[0] = HOVER
    start, end = QUADROTOR.hover_rotor_speed, QUADROTOR.motor_speed_max
    out, _ = driven(stiff(time_constant=0.05), throttle)[-1]
    share = (1.0 - math.exp(-DT / 0.05)) * 0.05 / DT
    assert out["rotor_speed"][0].tolist() == pytest.approx([end + share * (start - end)] * 4, rel=1e-9)


def test_the_battery_gives_what_the_motors_take_and_what_it_heats_itself_with():
    values = powertrain_values(QUADROTOR)
    throttle = 0.3 + 0.6 * torch.rand(
        200, 3, 4, dtype=torch.float64, generator=torch.Generator().manual_seed(0)
    )
    seen = driven(values, throttle)
    drawn = torch.zeros(3, dtype=torch.float64)
    for (_, before), (out, after) in itertools.pairwise(seen):
        current = (before["charge"] - after["charge"]) * values["capacity"] / DT
        taken = QUADROTOR.torque_coefficient * before["speed"].pow(3).sum(-1) / values["efficiency"]
        chemical = values["cells"] * batteries.open_circuit_voltage(before["charge"]) * current
        heat = values["resistance"] * current**2 + before["relaxation"] * current
        torch.testing.assert_close(chemical, taken + heat, rtol=1e-8, atol=1e-6)
        torch.testing.assert_close(out["battery_voltage"] * current, taken, rtol=1e-8, atol=1e-6)
        drawn += current * DT
    spent = (seen[0][1]["charge"] - seen[-1][1]["charge"]) * values["capacity"]
    torch.testing.assert_close(spent, drawn)
    assert (seen[-1][1]["relaxation"] > 0).all()


def test_an_empty_battery_turns_the_rotors_slower():
    throttle = torch.full((20, 1, 4), 0.8, dtype=torch.float64)
    full, empty = (
        driven({**powertrain_values(QUADROTOR), "charge": charge}, throttle)[-1][0] for charge in (1.0, 0.1)
    )
    assert (empty["rotor_speed"] < full["rotor_speed"]).all()
    assert (empty["battery_voltage"] < full["battery_voltage"]).all()


def test_a_small_quadrotor_flies_on_one_cell():
    assert powertrain_values(QUADROTOR)["cells"] == 4.0
    assert powertrain_values(replace(QUADROTOR, nominal_voltage=3.7))["cells"] == 1.0
