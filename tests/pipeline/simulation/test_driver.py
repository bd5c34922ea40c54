"""What drives an effect where nobody recorded it."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.effects import effect_by_key, effects_of
from simgap.simulation import FittedEffect, Simulator, read_simulator, step, write_simulator
from simgap.simulation.driver import SimulatedDriver, with_drivers, without_driver
from tests.pipeline.platforms.machines import MACHINES

SAG = FittedEffect(effect_by_key("quadrotor", "battery_sag"), {"sensitivity": 0.8})
SAGGING = Simulator(MACHINES["quadrotor"], (SAG,))


def flown(level: float, giving: float, noise: float = 0.0) -> dict[str, torch.Tensor]:
    """Return commands (20 blocks, 50 samples, 4 rotors) and the voltage of a battery that gives way to them."""
    random = torch.Generator().manual_seed(0)
    command = 0.3 + 0.6 * torch.rand(20, 50, 4, generator=random, dtype=torch.float64)
    load = (SAGGING.platform.motor_speed_max * command).pow(3).sum(-1)
    voltage = level - giving * load / load.mean()
    return {
        "motor_command": command,
        "battery_voltage": voltage
        + noise * torch.randn(voltage.shape, generator=random, dtype=torch.float64),
    }


@given(level=st.floats(5.0, 30.0), share=st.floats(0.0, 0.3))
def test_a_battery_without_a_recording_stands_where_it_stood_in_one(level, share):
    signals = flown(level, share * level)
    simulator = with_drivers(SAGGING, signals)
    command = {"motor_command": signals["motor_command"]}
    found = simulator.along_time(command, 0.01)["battery_voltage"]
    torch.testing.assert_close(found, signals["battery_voltage"])


def test_a_battery_that_rises_with_its_load_has_a_level_only():
    signals = flown(15.0, -1.0)
    (law,) = with_drivers(SAGGING, signals).of_type(SimulatedDriver)
    assert law.values["giving"] == 0.0
    assert law.values["level"] == pytest.approx(float(signals["battery_voltage"].mean()))


def test_a_winding_that_its_load_warms_late_has_a_level_only():
    derating = effect_by_key("joint", "temperature_derating")
    simulator = Simulator(MACHINES["joint"], (FittedEffect(derating, derating.defaults()),))
    load = torch.linspace(0.0, 1.0, 50, dtype=torch.float64)[None]
    signals = {
        "effort": load,
        "position": 0.0 * load,
        "velocity": 0.0 * load,
        "temperature": 40.0 + 5.0 * load**2,
    }
    (law,) = with_drivers(simulator, signals).of_type(SimulatedDriver)
    assert law.values["giving"] == 0.0
    assert law.values["level"] == pytest.approx(float(signals["temperature"].mean()))


def test_what_is_given_is_not_simulated():
    signals = flown(15.0, 1.0)
    simulator = with_drivers(SAGGING, signals)
    given = {**signals, "battery_voltage": torch.full_like(signals["battery_voltage"], 11.0)}
    torch.testing.assert_close(
        simulator.along_time(given, 0.01)["rotor_speed"], SAGGING.along_time(given, 0.01)["rotor_speed"]
    )


def test_a_step_is_that_of_the_voltage_that_a_recording_had():
    signals = flown(15.0, 1.0)
    state = torch.zeros(20, 13, dtype=torch.float64)
    state[:, 3] = 1.0
    now = {name: series[:, 0] for name, series in signals.items()}
    simulated, _ = step(with_drivers(SAGGING, signals), state, {"motor_command": now["motor_command"]}, 0.01)
    torch.testing.assert_close(simulated, step(SAGGING, state, now, 0.01)[0])


def test_only_what_nothing_drives_is_without_a_driver():
    assert without_driver(SAGGING) == (SAG,)
    assert without_driver(with_drivers(SAGGING, flown(15.0, 1.0))) == ()
    assert without_driver(Simulator(MACHINES["quadrotor"])) == ()


def test_a_driver_is_simulated_once():
    once = with_drivers(SAGGING, flown(15.0, 1.0))
    again = with_drivers(once, flown(14.0, 0.5))
    assert len(again.of_type(SimulatedDriver)) == 1
    assert again == with_drivers(SAGGING, flown(14.0, 0.5))


@pytest.mark.parametrize("kind", MACHINES)
def test_simulated_drivers_of_every_effect_come_back_from_a_file(kind, tmp_path):
    driven = [effect for effect in effects_of(kind) if effect.driver]
    assert driven
    for number, effect in enumerate(driven):
        law = FittedEffect(SimulatedDriver(effect), {"level": 12.5, "giving": 0.25}, known=True)
        simulator = Simulator(MACHINES[kind], (FittedEffect(effect, effect.defaults()), law))
        folder = tmp_path / str(number)
        write_simulator(simulator, folder)
        assert read_simulator(folder) == simulator
