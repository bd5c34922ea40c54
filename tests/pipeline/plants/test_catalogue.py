"""What a key says is what the catalogue's own laws find in a perfect recording, name by name."""

import functools

import numpy as np
import pytest
import torch

from simgap.effects.catalogue import effect_by_key, effects_of
from simgap.physics import rotations
from simgap.plants.case import PlantCase, Sensors
from simgap.plants.concealable import CONCEALABLE, machine_size
from simgap.plants.concealment import typical
from simgap.plants.fly import fly
from simgap.platforms.quadrotor_mechanism import QuadrotorMechanism

RATE = 500.0
CHANNELS = [f"{stem}_{axis}" for stem in ("force", "torque") for axis in "xyz"]


def flown(racer, effects, **kwargs):
    case = PlantCase(
        effects=effects,
        runs=4,
        duration=2.0,
        rate=RATE,
        sensors=Sensors(scale=0.0),
        charge=[0.3, 1.0],
        **kwargs,
    )
    recording, key = fly(case, racer, seed=5)
    return signals(recording.frame), {entry["name"]: entry["parameters"] for entry in key["effects"]}


def signals(frame):
    """Return the recording as the catalogue's signals (runs, samples, ...)."""
    runs = frame["run"].nunique()

    def columns(name, axes):
        values = frame[[f"{name}_{axis}" for axis in axes]].to_numpy(copy=True)
        return torch.from_numpy(values).reshape(runs, -1, len(axes))

    attitude = columns("attitude", "wxyz")
    return {
        "position": columns("position", "xyz"),
        "attitude": attitude,
        "velocity": rotations.rotate_inverse(attitude, columns("velocity", "xyz")),
        "body_rate": columns("body_rate", "xyz"),
        "specific_force": columns("specific_force", "xyz"),
        "rotor_speed": columns("motor_speed", "1234"),
        "motor_command": columns("motor_command", "1234"),
        "battery_voltage": torch.from_numpy(frame["battery_voltage"].to_numpy(copy=True)).reshape(runs, -1),
    }


def wrench_of(seen, constants):
    """Return specific force and torque that were there, channel by channel, by central differences of the turning."""
    (turning,) = torch.gradient(seen["body_rate"], spacing=1.0 / RATE, dim=1)
    inertia = constants["inertia"]
    torque = inertia * turning + rotations.cross(seen["body_rate"], inertia * seen["body_rate"])
    both = torch.cat((seen["specific_force"], torque), dim=-1)
    return {channel: both[..., place] for place, channel in enumerate(CHANNELS)}


def stacked(wrench, like):
    """Return all channels of a wrench, torques in the unit of angular acceleration, ends left out."""
    zero = torch.zeros_like(like["rotor_speed"][..., 0])
    size = {"f": 1.0, "t": 4e-3}  # kg·m² of the racer
    parts = [wrench.get(channel, zero) / size[channel[0]] for channel in CHANNELS]
    return torch.stack(parts)[..., 2:-2].flatten().numpy()


def unexplained(seen, mechanism, constants):
    there, nominal = wrench_of(seen, constants), mechanism.wrench(seen, constants)
    return stacked({channel: there[channel] - nominal[channel] for channel in CHANNELS}, seen)


PUSHING = {
    "ground_effect": {"ground_effect": 1e-3},
    "rotor_fault@2": {"rotor_fault": {"loss_2": 0.15}},
    "center_of_mass_offset": {"center_of_mass_offset": {"offset_x": 0.006, "offset_y": -0.004}},
    "blade_flapping_moment": {"blade_flapping_moment": 5e-3},
    "rotor_inertia_torque": {"rotor_inertia_torque": 9e-6, "motor_lag": 0.03},
    "gyroscopic_torque": {"gyroscopic_torque": 3e-5},
    "angular_drag": {"angular_drag": 5e-3},
    "yaw_trim": {"yaw_trim": 0.1},
    "rotor_thrust_spread": {"rotor_thrust_spread": {"excess_1": 0.05, "excess_2": -0.06, "excess_3": 0.02}},
    "steady_wind": {"steady_wind": {"wind_x": 4.0, "wind_y": -2.0}, "rotor_drag": 0.35},
}


@pytest.mark.slow
@pytest.mark.parametrize("key", PUSHING)
def test_its_law_finds_the_parameters_of_the_key(racer, key):
    seen, truth = flown(racer, PUSHING[key])
    mechanism = QuadrotorMechanism(racer)
    constants = mechanism.constants()
    names = [key, *(other for other in PUSHING[key] if key == "steady_wind" and other != key)]
    regressors, expected = [], []
    for name in names:
        effect = effect_by_key("quadrotor", name)
        acts = getattr(effect, "along_time", None)
        acted = acts(seen, effect.defaults(), constants, 1.0 / RATE) if acts else seen
        regressors += [stacked(part, seen) for part in effect.regressors(acted, constants)]
        told = truth[effect.name]
        # How a wind is felt along the rotors' axis, or at speed, is a shape: without a push it has no column.
        expected += [told[p.name]["value"] if p.name in told else 0.0 for p in effect.parameters]
    residual = unexplained(seen, mechanism, constants)
    found = np.linalg.lstsq(np.stack(regressors, axis=-1), residual, rcond=1e-6)[0]
    np.testing.assert_allclose(found, expected, rtol=0.04, atol=0.02 * np.abs(expected).max())
    left = residual - np.stack(regressors, axis=-1) @ found
    assert (left**2).sum() < 0.25 * (residual**2).sum()  # differences of the turning leave some of it


@pytest.mark.slow
@pytest.mark.parametrize("name", ["inertia_error", "torque_coefficient_error"])
def test_a_corrected_number_leaves_nothing_unexplained(racer, name):
    seen, truth = flown(racer, {name: 1.3})
    mechanism, effect = QuadrotorMechanism(racer), effect_by_key("quadrotor", name)
    constants = mechanism.constants()
    corrected = effect.adjust(constants, {"ratio": truth[name]["ratio"]["value"]})
    before, after = (unexplained(seen, mechanism, numbers) for numbers in (constants, corrected))
    assert (after**2).sum() < 1e-3 * (before**2).sum()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("key", "strength"),
    [
        ("motor_lag", 0.04),
        ("motor_lag", {"time_constant": 0.04, "down_ratio": 1.8}),
        ("command_delay", 0.022),
        ("battery_sag", 0.8),
    ],
)
def test_commands_become_rotor_speeds_as_the_key_says(racer, key, strength):
    seen, truth = flown(racer, {key: strength})
    mechanism, effect = QuadrotorMechanism(racer), effect_by_key("quadrotor", key)
    constants = mechanism.constants()
    values = {parameter: entry["value"] for parameter, entry in truth[key].items()}
    speed = seen["rotor_speed"]
    believed = mechanism.actuate({name: seen[name] for name in seen if name != "rotor_speed"}, constants)
    delayed = effect.along_time(believed, values, constants, 1.0 / RATE)
    if key == "command_delay":
        delayed = mechanism.actuate({"motor_command": delayed["motor_command"]}, constants)
    settled = slice(round(0.3 * RATE), None)
    before = (believed["rotor_speed"] - speed)[:, settled]
    after = (delayed["rotor_speed"] - speed)[:, settled]
    assert after.square().sum() < 0.05 * before.square().sum()


@pytest.mark.slow
def test_rotors_turn_at_the_scale_of_the_key(racer):
    seen, truth = flown(racer, {"command_scale_error": 1.06})
    constants = QuadrotorMechanism(racer).constants()
    ratio = truth["command_scale_error"]["ratio"]["value"]
    corrected = effect_by_key("quadrotor", "command_scale_error").adjust(constants, {"ratio": ratio})
    expected = corrected["motor_speed_max"] * seen["motor_command"]
    np.testing.assert_allclose((seen["rotor_speed"] / expected).mean(), 1.0, atol=1e-3)
    assert (seen["rotor_speed"] / expected - 1.0).abs().max() < 0.01  # motors differ by a little


@pytest.mark.slow
def test_the_pendulum_of_the_catalogue_pulls_as_the_payload_does(racer):
    seen, truth = flown(racer, {"slung_payload": {"mass_ratio": 0.2, "length": 0.6}})
    mechanism, effect = QuadrotorMechanism(racer), effect_by_key("quadrotor", "slung_payload")
    constants = mechanism.constants()
    values = {parameter: entry["value"] for parameter, entry in truth["slung_payload"].items()}
    residual = unexplained(seen, mechanism, constants)

    def left(**changed):
        pulled = effect.along_time(seen, values | changed, constants, 1.0 / RATE)
        return ((residual - stacked(effect.wrench(pulled, values | changed, constants), seen)) ** 2).sum()

    assert left() < 0.2 * (residual**2).sum()  # how it swung before the recording began is not known
    assert left() < min(left(length=0.9), left(length=0.4), left(mass_ratio=0.15))


@functools.cache
def listed(kind):
    return {
        effect.name: {p.name: p.unit for e in effects_of(kind) if e.name == effect.name for p in e.parameters}
        for effect in effects_of(kind)
    }


def test_names_and_units_of_the_key_are_those_of_the_catalogue(racer):
    effects = {name: typical(name, CONCEALABLE, machine_size(racer)) for name in CONCEALABLE}
    case = PlantCase(effects=effects, runs=1, duration=0.05)
    _, key = fly(case, racer, seed=0)
    assert {entry["name"] for entry in key["effects"]} == set(CONCEALABLE)
    for entry in key["effects"]:
        units = listed("quadrotor")[entry["name"]]
        assert {
            parameter: value["unit"] for parameter, value in entry["parameters"].items()
        }.items() <= units.items()
