import numpy as np
import pytest
import torch

from simgap.physics import rotations
from simgap.plants.case import PlantCase, Sensors
from simgap.plants.fly import fly

STRENGTHS = {"rotor_drag": 0.4, "axial_inflow": 0.3, "translational_lift": 0.02, "body_drag": 0.04}


def columns(frame, name, axes):
    return frame[[f"{name}_{axis}" for axis in axes]].to_numpy()


def regressed(frame, racer, effect):
    """Fit the law of the contract to what a perfect recording leaves unexplained by the nominal model."""
    attitude = torch.from_numpy(columns(frame, "attitude", "wxyz").copy())
    velocity = rotations.rotate_inverse(
        attitude, torch.from_numpy(columns(frame, "velocity", "xyz").copy())
    ).numpy()
    speed = columns(frame, "motor_speed", "1234")
    residual = columns(frame, "specific_force", "xyz").copy()
    residual[:, 2] -= racer.thrust_coefficient / racer.mass * (speed**2).sum(axis=1)
    spin = speed.mean(axis=1) / racer.hover_rotor_speed
    law = np.zeros_like(velocity)
    if effect == "rotor_drag":
        law[:, :2] = -spin[:, None] * velocity[:, :2]
    elif effect == "axial_inflow":
        law[:, 2] = -spin * velocity[:, 2]
    elif effect == "translational_lift":
        law[:, 2] = velocity[:, 0] ** 2 + velocity[:, 1] ** 2
    else:
        law = -np.linalg.norm(velocity, axis=1, keepdims=True) * velocity
    return (law * residual).sum() / (law**2).sum()


@pytest.mark.slow
@pytest.mark.parametrize("effect", STRENGTHS)
def test_a_regression_on_a_perfect_recording_finds_what_the_key_says(racer, effect):
    case = PlantCase(effects={effect: STRENGTHS[effect]}, runs=5, duration=1.0, sensors=Sensors(scale=0.0))
    recording, key = fly(case, racer, seed=4)
    (entry,) = key["effects"]
    assert entry["name"] == effect
    true = entry["parameters"]["coefficient"]["value"]
    assert regressed(recording.frame, racer, effect) == pytest.approx(true, rel=0.01)
    assert true == pytest.approx(STRENGTHS[effect], rel=0.2)


def test_the_null_case_leaves_nothing_unexplained(racer):
    case = PlantCase(runs=5, duration=1.0, sensors=Sensors(scale=0.0))
    recording, key = fly(case, racer, seed=4)
    assert key["effects"] == []
    for effect in STRENGTHS:
        assert abs(regressed(recording.frame, racer, effect)) < 1e-6


def test_the_torque_that_turning_costs_the_rotors_is_in_the_key(racer):
    case = PlantCase(effects={"rotor_drag": 0.4}, arm=1.0, runs=2, duration=0.5)
    _, key = fly(case, racer, seed=4)
    drag, angular = key["effects"]
    assert (drag["name"], angular["name"]) == ("rotor_drag", "angular_drag")
    coefficient = angular["parameters"]["coefficient"]
    assert coefficient["unit"] == "N·m·s/rad"
    reach = sum(x * x + y * y for x, y, _ in racer.rotor_positions) / 4
    assert 0 < coefficient["value"] < 1.2 * 0.4 * racer.mass * reach  # about z alone; the law has all axes
    assert fly(PlantCase(arm=1.0, runs=1, duration=0.1), racer, seed=4)[1]["effects"] == []


def test_parameters_that_are_wrong_in_the_platform_file_are_in_the_key(racer):
    effects = {
        "mass_error": 1.15,
        "thrust_coefficient_error": 0.9,
        "sensor_time_offset": 0.02,
        "motor_lag": 0.03,
    }
    _, key = fly(PlantCase(effects=effects, runs=1, duration=0.2), racer, seed=0)
    found = {entry["name"]: next(iter(entry["parameters"].values())) for entry in key["effects"]}
    assert {name: parameter["value"] for name, parameter in found.items()} == effects
    assert found["motor_lag"]["unit"] == "s"
