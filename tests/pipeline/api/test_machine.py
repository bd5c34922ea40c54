"""One shape rule for every kind of machine."""

import math

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import mutually_broadcastable_shapes

from simgap.api.layout import recorded_command
from simgap.api.machine import Machine
from simgap.api.memory import Memory
from simgap.api.simulators import build_simulator, load_simulator
from simgap.errors import InputError
from simgap.platforms import Joint
from simgap.recordings.contract import channel_units
from simgap.simulation import FittedEffect, Simulator, write_simulator
from simgap.simulation.driver import SimulatedDriver
from tests.pipeline.api.machines import DT, REMEMBERING, bare, commands, remembering, states
from tests.pipeline.platforms.machines import JOINT, MACHINES, QUADROTOR, SWERVE

KINDS = pytest.mark.parametrize("kind", list(MACHINES))
HIDDEN = pytest.mark.parametrize("effect", list(REMEMBERING))


def test_a_quadrotor_without_thrust_falls_freely():
    machine = bare("quadrotor")
    path = machine.rollout(machine.state(position_z=50.0, velocity_x=3.0), np.zeros((100, 4)), DT)
    time = DT * np.arange(101)
    expected = np.tile(machine.state(), (101, 1))
    expected[:, 0], expected[:, 2] = 3.0 * time, 50.0 - 0.5 * QUADROTOR.gravity * time**2
    expected[:, 7], expected[:, 9] = 3.0, -QUADROTOR.gravity * time
    np.testing.assert_allclose(path, expected, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("unit", ["rad", "m"])
def test_a_joint_under_constant_effort_accelerates_evenly(unit):
    machine = build_simulator(Joint(inertia=2.0), position_unit=unit)
    path = machine.rollout(machine.state(velocity=-1.0), np.full((50, 1), 3.0), DT)
    time = DT * np.arange(51)
    np.testing.assert_allclose(path[:, 0], -time + 0.75 * time**2, atol=1e-12)
    np.testing.assert_allclose(path[:, 1], -1.0 + 1.5 * time, atol=1e-12)


@pytest.mark.slow
def test_a_swerve_drive_straight_ahead_approaches_its_free_speed():
    machine, motor, gear = bare("swerve"), SWERVE.drive.motor, SWERVE.drive.gear_ratio
    volts = np.zeros((100, 8))
    volts[:, :4] = 6.0
    path = machine.rollout(machine.state(), volts, DT, substeps=4)
    per_speed = motor.back_emf_constant * gear / SWERVE.wheel_radius  # V/(m/s)
    force = 4.0 * motor.torque_constant * gear / SWERVE.wheel_radius / motor.resistance  # N/V
    rate = force * per_speed / SWERVE.mass
    speed = 6.0 / per_speed * -np.expm1(-rate * DT * np.arange(101))
    np.testing.assert_allclose(path[:, 0], speed, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(path[:, 1:], 0.0, atol=1e-9)


@KINDS
def test_entries_are_called_as_the_columns_of_a_recording(kind):
    machine = bare(kind)
    known = channel_units(kind) | {"heading": "rad"}
    assert machine.kind == kind
    assert machine.platform == MACHINES[kind]
    assert machine.units == {name: known[name] for name in (*machine.state_names, *machine.command_names)}
    assert machine.state(**{machine.state_names[-1]: 0.5})[-1] == 0.5


@pytest.mark.parametrize(
    ("kind", "command", "names"),
    [
        ("quadrotor", "motor_speed", [f"motor_speed_{rotor}" for rotor in range(1, 5)]),
        ("joint", "effort", ["effort"]),
        ("joint", None, ["voltage"]),
    ],
)
def test_a_machine_is_driven_by_what_is_chosen(kind, command, names):
    assert list(bare(kind, command).command_names) == names


@pytest.mark.parametrize(
    ("kind", "signals", "command"),
    [
        ("quadrotor", ["attitude", "rotor_speed"], "motor_speed"),
        ("quadrotor", ["rotor_speed", "motor_command"], "motor_command"),
        ("joint", ["effort", "position"], "effort"),
        ("joint", ["effort", "voltage"], "voltage"),
        ("swerve", ["drive_voltage", "steer_voltage"], "voltages"),
        ("swerve", ["drive_voltage"], None),
    ],
)
def test_a_recorded_machine_is_driven_by_what_was_recorded(kind, signals, command):
    assert recorded_command(kind, signals) == command


def test_hover_at_the_speed_that_carries_the_weight():
    machine = bare("quadrotor", "motor_speed")
    hover = np.full((20, 4), QUADROTOR.hover_rotor_speed)
    path = machine.rollout(machine.state(position_z=1.0), hover, DT)
    np.testing.assert_allclose(path[:, 2], 1.0, atol=1e-12)


@HIDDEN
def test_a_rollout_is_repeated_steps_with_one_memory(effect):
    machine = remembering(effect)
    inputs, memory = commands(machine, (2, 12)), Memory()
    path = [states(machine, (2,))]
    for index in range(12):
        path.append(machine.step(path[-1], inputs[:, index], DT, memory, substeps=2))
    whole = machine.rollout(path[0], inputs, DT, substeps=2)
    np.testing.assert_array_equal(np.stack(path, axis=-2), whole)


@HIDDEN
def test_a_memory_carries_hidden_states_from_rollout_to_rollout(effect):
    machine = remembering(effect)
    start, inputs, memory = states(machine, ()), commands(machine, (20,)), Memory()
    whole = machine.rollout(start, inputs, DT)
    first = machine.rollout(start, inputs[:10], DT, memory)
    aside = memory.copy()
    second = machine.rollout(first[-1], inputs[10:], DT, memory)
    np.testing.assert_array_equal(np.concatenate([first, second[1:]]), whole)
    np.testing.assert_array_equal(machine.rollout(first[-1], inputs[10:], DT, aside), second)
    assert np.abs(machine.rollout(first[-1], inputs[10:], DT) - second).max() > 1e-6


@HIDDEN
def test_arrays_and_tensors_give_the_same(effect):
    machine = remembering(effect)
    start, inputs = states(machine, (3,)), commands(machine, (3, 5))
    arrays = machine.rollout(start, inputs, DT)
    tensors = machine.rollout(torch.from_numpy(start), torch.from_numpy(inputs), DT)
    assert isinstance(arrays, np.ndarray)
    assert isinstance(tensors, torch.Tensor)
    np.testing.assert_array_equal(arrays, tensors.numpy())
    assert isinstance(machine.step(start, inputs[:, 0], DT), np.ndarray)
    assert isinstance(machine.step(torch.from_numpy(start), inputs[:, 0], DT), torch.Tensor)


@settings(max_examples=12)
@given(
    shapes=mutually_broadcastable_shapes(num_shapes=2, max_dims=2, max_side=3),
    steps=st.integers(0, 3),
    effect=st.sampled_from(list(REMEMBERING)),
)
def test_a_batch_is_its_machines_one_by_one(shapes, steps, effect):
    machine = remembering(effect)
    one, other = shapes.input_shapes
    start, inputs = states(machine, one), commands(machine, (*other, steps))
    together = machine.rollout(start, inputs, DT)
    batch = shapes.result_shape
    assert together.shape == (*batch, steps + 1, len(machine.state_names))
    starts = np.broadcast_to(start, (*batch, start.shape[-1]))
    series = np.broadcast_to(inputs, (*batch, *inputs.shape[-2:]))
    for place in np.ndindex(*batch):
        alone = machine.rollout(starts[place], series[place], DT)
        np.testing.assert_allclose(together[place], alone, rtol=1e-10, atol=1e-10)


@KINDS
def test_precision_stays_and_whole_numbers_become_double(kind):
    machine = bare(kind)
    start, inputs = states(machine, ()), commands(machine, (3,))
    assert machine.rollout(start, inputs, DT).dtype == np.float64
    single = machine.rollout(start.astype(np.float32), inputs.astype(np.float32), DT)
    assert single.dtype == np.float32
    assert machine.step(machine.state(), [0] * len(machine.command_names), DT).dtype == np.float64
    assert machine.step(start.astype(np.float32), inputs[0], DT).dtype == np.float64


def test_what_was_given_is_left_as_it_was():
    machine = bare("joint")
    start, inputs = machine.state(position=1.0), np.ones((4, 1))
    path = machine.rollout(start, inputs, DT)
    path[:] = 7.0
    np.testing.assert_array_equal(start, [1.0, 0.0])
    np.testing.assert_array_equal(inputs, 1.0)


def test_gradients_pass_through():
    machine = build_simulator(Joint(inertia=2.0))
    inputs = torch.zeros(10, 1, dtype=torch.float64, requires_grad=True)
    machine.rollout(torch.zeros(2, dtype=torch.float64), inputs, 0.1)[-1, 1].backward()
    torch.testing.assert_close(inputs.grad, torch.full_like(inputs, 0.1 / 2.0))


@pytest.mark.parametrize(
    ("start", "inputs", "line"),
    [
        ((13,), (100, 3), "commands must be (..., steps, 4); got (100, 3)"),
        ((13,), (4,), "commands must be (..., steps, 4); got (4,)"),
        ((12,), (100, 4), "state must be (..., 13); got (12,)"),
        ((2, 13), (3, 5, 4), "the leading dimensions must broadcast: state (2,), commands (3,)"),
    ],
)
def test_a_wrong_shape_is_refused_by_the_shape_that_was_expected(start, inputs, line):
    with pytest.raises(InputError) as refused:
        bare("quadrotor").rollout(np.zeros(start), np.zeros(inputs), DT)
    assert str(refused.value) == line


def test_a_step_names_the_shape_of_a_command():
    with pytest.raises(InputError) as refused:
        bare("quadrotor").step(np.zeros(13), np.zeros(3), DT)
    assert str(refused.value) == "command must be (..., 4); got (3,)"


@pytest.mark.parametrize("dt", [0.0, -0.1, math.nan])
def test_a_time_step_that_is_none_is_refused(dt):
    with pytest.raises(InputError, match="dt must be a positive number of seconds"):
        bare("joint").step(np.zeros(2), np.zeros(1), dt)


def test_what_is_no_number_is_refused():
    with pytest.raises(InputError, match="command: is no array of numbers"):
        bare("joint").step(np.zeros(2), ["much"], DT)
    with pytest.raises(InputError, match="substeps must be at least 1"):
        bare("joint").step(np.zeros(2), np.zeros(1), DT, substeps=0)
    with pytest.raises(InputError, match="the state of a joint has no 'angle'"):
        bare("joint").state(angle=1.0)


def test_a_memory_is_of_one_batch_and_one_time_step():
    machine, memory = remembering("command_delay"), Memory()
    machine.step(states(machine, (2,)), commands(machine, (2,)), DT, memory)
    with pytest.raises(InputError, match=r"memory is of machines \(2,\); got \(3,\)"):
        machine.step(states(machine, (3,)), commands(machine, (3,)), DT, memory)
    with pytest.raises(InputError, match=r"integration steps of 0\.01 s; got 0\.005 s"):
        machine.step(states(machine, (2,)), commands(machine, (2,)), DT, memory, substeps=2)


def sagging(driven: bool) -> Machine:
    machine = build_simulator(JOINT, {"battery_sag": {"share": 1.0, "nominal_voltage": 12.0}})
    (sag,) = machine.effects
    law = FittedEffect(SimulatedDriver(sag.effect), {"level": 6.0, "giving": 0.0}, known=True)
    return Machine(Simulator(JOINT, (sag, law))) if driven else machine


def test_a_battery_is_given_or_as_it_was_recorded():
    machine, inputs = sagging(driven=False), np.full((5, 1), 4.0)
    with pytest.raises(InputError, match=r"battery_sag needs battery_voltage; give exogenous="):
        machine.rollout(machine.state(), inputs, DT)
    half = machine.rollout(machine.state(), inputs, DT, exogenous={"battery_voltage": np.full(5, 6.0)})
    np.testing.assert_allclose(half, bare("joint").rollout(machine.state(), 0.5 * inputs, DT), atol=1e-12)
    np.testing.assert_array_equal(
        half, machine.rollout(machine.state(), inputs, DT, exogenous={"battery_voltage": 6.0})
    )
    np.testing.assert_allclose(sagging(driven=True).rollout(machine.state(), inputs, DT), half, atol=1e-12)
    one = machine.step(machine.state(), inputs[0], DT, exogenous={"battery_voltage": 6.0})
    np.testing.assert_array_equal(one, half[1])


def test_inputs_that_no_machine_has_are_refused():
    with pytest.raises(InputError, match="there is no exogenous input 'wind'"):
        bare("joint").step(np.zeros(2), np.zeros(1), DT, exogenous={"wind": 1.0})
    with pytest.raises(
        InputError, match="a joint is not driven by 'motor_command'; use 'voltage' or 'effort'"
    ):
        bare("joint", "motor_command")
    with pytest.raises(InputError, match=r"platform\.motor: is missing"):
        build_simulator(Joint(inertia=1.0), command="voltage")
    effort = build_simulator(JOINT, {"motor_inductance": {}}, command="effort")
    with pytest.raises(InputError, match="motor_inductance needs voltage; give command='voltage'"):
        effort.step(np.zeros(2), np.zeros(1), DT)


@pytest.mark.parametrize("convert", [str, lambda path: path])
@pytest.mark.parametrize("inside", ["", "simulator"])
def test_a_simulator_is_loaded_from_its_folder_or_the_answers(tmp_path, convert, inside):
    machine = build_simulator(JOINT, {"coulomb_friction": {"level": 0.2}})
    write_simulator(machine.simulator, tmp_path / inside)
    loaded = load_simulator(convert(tmp_path))
    start, inputs = machine.state(velocity=1.0), commands(machine, (6,))
    np.testing.assert_array_equal(loaded.rollout(start, inputs, DT), machine.rollout(start, inputs, DT))
    assert repr(loaded) == "Machine(joint, command: voltage, effects: coulomb_friction)"
    assert load_simulator(convert(tmp_path), command="effort").command_names == ("effort",)


def test_a_folder_without_a_simulator_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"simulator\.yaml: no simulator can be read"):
        load_simulator(tmp_path)
