import numpy as np
import pytest

from simgap.plants.battery import Battery


def test_without_load_it_shows_its_rested_voltage(racer):
    battery = Battery(racer, np.array([0.5, 1.0]))
    rested = battery.rested()
    np.testing.assert_allclose(battery(np.zeros((2, 4)), 1.0), rested)
    # Chen & Rincón-Mora, equation (2), four cells at full charge.
    assert rested[1] == pytest.approx(4 * (3.685 + 0.2156 - 0.1178 + 0.3201 - 1.031 * np.exp(-35.0)))
    assert rested[0] < rested[1]


def test_load_costs_voltage_at_once_and_more_after_a_while(racer):
    battery = Battery(racer, np.ones(1))
    hover = np.full((1, 4), racer.hover_rotor_speed)
    rested = battery.rested()[0]
    first = battery(hover, 1e-3)[0]
    assert rested - first == pytest.approx(0.03 * racer.nominal_voltage, rel=0.15)
    for _ in range(4000):
        battery(hover, 0.01)
    later = battery(hover, 1e-3)[0]
    lost = battery.rested()[0] - later
    assert lost == pytest.approx(0.05 * racer.nominal_voltage, rel=0.15)


def test_terminals_deliver_what_the_rotors_draw(racer):
    battery, speed = Battery(racer, np.ones(1), wear=2.0), np.full((1, 4), 1500.0)
    before = battery.charge.copy()
    rested = battery.rested()
    voltage = battery(speed, 1e-3)
    current = (rested - voltage) / battery.series
    shaft = 4 * racer.torque_coefficient * 1500.0**3
    np.testing.assert_allclose(voltage * current * 0.6, shaft)
    np.testing.assert_allclose((before - battery.charge) * battery.capacity, current * 1e-3)


def test_a_worn_pack_sags_more(racer):
    speed = np.full((1, 4), 1500.0)
    fresh, worn = (Battery(racer, np.ones(1), wear)(speed, 1e-3) for wear in (1.0, 3.0))
    assert worn < fresh


def test_more_than_it_can_give_gives_the_most_it_can(racer):
    battery = Battery(racer, np.ones(1))
    rested = battery.rested()
    np.testing.assert_allclose(battery(np.full((1, 4), 1e5), 1e-3), rested / 2)
