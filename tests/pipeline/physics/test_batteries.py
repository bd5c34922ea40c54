import hypothesis.strategies as st
import pytest
import torch
from hypothesis import given

from simgap.physics import batteries


def test_voltage_falls_with_charge():
    charge = torch.linspace(0.02, 1.0, 50, dtype=torch.float64)
    voltage = batteries.open_circuit_voltage(charge, cells=4)
    assert (voltage.diff() > 0).all()
    assert float(voltage[-1]) == pytest.approx(4 * 4.1, rel=0.02)


@given(st.floats(0.0, 200.0), st.floats(10.0, 25.0), st.floats(0.005, 0.1))
def test_current_delivers_the_power_where_the_battery_can(power, source, resistance):
    current = batteries.current_for_power(
        torch.tensor(power, dtype=torch.float64), torch.tensor(source, dtype=torch.float64), resistance
    )
    delivered = (source - resistance * float(current)) * float(current)
    assert delivered == pytest.approx(min(power, source**2 / (4 * resistance)), rel=1e-6, abs=1e-9)


def test_relaxation_tends_to_resistance_times_current():
    relaxation = torch.zeros(1, dtype=torch.float64)
    for _ in range(200):
        relaxation = batteries.relaxation_step(relaxation, torch.tensor([10.0]).double(), 0.02, 50.0, 0.1)
    assert float(relaxation) == pytest.approx(0.2, rel=1e-6)


def test_charge_is_counted():
    charge = batteries.charge_step(torch.tensor(1.0), torch.tensor(3.6), capacity=3.6 * 1000, dt=100.0)
    assert float(charge) == pytest.approx(0.9)


def test_terminal_voltage_sags_under_load():
    rested = torch.tensor(16.0)
    loaded = batteries.terminal_voltage(rested, torch.tensor(0.1), torch.tensor(20.0), 0.02)
    assert float(loaded) == pytest.approx(15.5)


def test_gradients():
    charge = torch.tensor([0.2, 0.8], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(batteries.open_circuit_voltage, charge)
    power = torch.tensor([50.0, 90.0], dtype=torch.float64, requires_grad=True)
    source = torch.tensor([16.0, 15.0], dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(lambda p, e: batteries.current_for_power(p, e, 0.05), (power, source))
