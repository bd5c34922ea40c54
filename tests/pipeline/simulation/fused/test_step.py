"""The fused step against the eager one."""

from dataclasses import replace

import pytest
import torch

from simgap.effects import ActuatorEffect, CommandEffect, WrenchEffect, effect_by_key, effects_of
from simgap.errors import InputError
from simgap.simulation import FittedEffect, Simulator, step
from simgap.simulation.flight import racing_flight
from simgap.simulation.fused import FusedStep
from simgap.simulation.fused.trace import component_graph
from simgap.simulation.motion import motion_of
from tests.pipeline.platforms.machines import MACHINES, QUADROTOR, some_signals
from tests.pipeline.simulation.test_flight import actions, tumbling

COMMANDS = {
    "quadrotor": ("motor_command", "battery_voltage"),
    "swerve": ("drive_voltage", "steer_voltage", "battery_voltage"),
    "joint": ("voltage", "battery_voltage", "temperature"),
}
BATCH = 40


def racer():
    effect = effect_by_key("quadrotor", "rotor_inertia_torque")
    return racing_flight(
        QUADROTOR, (FittedEffect(effect, effect.defaults()),), integrator="euler", substeps=1
    )


def start(flight, dtype: torch.dtype):
    action = actions(BATCH, seed=2, dtype=dtype)
    return *flight.step(tumbling(BATCH, seed=1, dtype=dtype), action), action


@pytest.mark.slow
def test_the_compiled_racer_flies_as_the_eager_one():
    flight = racer()
    state, action = tumbling(BATCH, seed=1, dtype=torch.float32), actions(BATCH, seed=2, dtype=torch.float32)
    state[:, 10:] *= 0.1  # where no rotor saturates, rounding grows less than the tolerance
    state, memory = flight.step(state, action)
    fused = FusedStep(flight.step, state, action, memory, repeats=2)
    rows = fused.pack(state, memory)
    for _ in range(3):
        rows = fused(rows, action.T.contiguous())
    for _ in range(6):
        state, memory = flight.step(state, action, memory)
    found, kept = fused.unpack(rows)
    size = state.abs().amax(0).clamp_min(1.0)
    torch.testing.assert_close(found / size, state / size, rtol=0.0, atol=1e-5)
    few = fused(rows[:, :3].contiguous(), action[:3].T.contiguous())
    torch.testing.assert_close(few, fused(rows, action.T.contiguous())[:, :3], rtol=1e-6, atol=1e-6)
    (regulating, (drive, *_)), (regulated, (driven, *_)) = memory, kept
    fastest = drive["speed"].max()
    torch.testing.assert_close(driven["speed"] / fastest, drive["speed"] / fastest, rtol=0.0, atol=1e-5)
    torch.testing.assert_close(driven["charge"], drive["charge"], rtol=1e-5, atol=0.0)
    torch.testing.assert_close(regulated["integral"], regulating["integral"], rtol=1e-5, atol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("integrator", ["euler", "semi_implicit", "rk4"])
def test_the_whole_control_step_is_written_down_as_it_is(integrator):
    """The graph that is compiled, run as it stands in double precision."""
    effects = (effect_by_key("quadrotor", key) for key in ("rotor_inertia_torque", "grey_box_aerodynamics"))
    flight = racing_flight(
        QUADROTOR, tuple(FittedEffect(e, e.defaults()) for e in effects), integrator=integrator, substeps=2
    )
    state, memory, action = start(flight, torch.float64)
    fused = FusedStep(flight.step, state, action, memory)
    found = fused._graph(fused.pack(state, memory), action.T)
    torch.testing.assert_close(found, fused.pack(*flight.step(state, action, memory)), rtol=1e-9, atol=1e-7)


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(MACHINES))
def test_every_effect_of_the_catalogue_can_be_fused(kind):
    chosen = [e for e in effects_of(kind) if isinstance(e, ActuatorEffect | WrenchEffect | CommandEffect)]
    simulator = Simulator(MACHINES[kind], tuple(FittedEffect(e, e.defaults()) for e in chosen))
    signals = some_signals(kind, (BATCH,), seed=3)
    names = COMMANDS[kind]
    widths = [signals[name][:1].numel() for name in names]

    def taken(state, action, memory):
        parts = action.split(widths, dim=-1)
        command = {n: p.reshape(-1, *signals[n].shape[1:]) for n, p in zip(names, parts, strict=True)}
        return step(simulator, state, command, 0.004, memory)

    action = torch.cat([signals[name].reshape(BATCH, -1) for name in names], dim=1)
    state, memory = taken(motion_of(MACHINES[kind]).pack(signals), action, ())
    fused = FusedStep(taken, state, action, memory)
    found = fused._graph(fused.pack(state, memory), action.T)
    torch.testing.assert_close(found, fused.pack(*taken(state, action, memory)), rtol=1e-8, atol=1e-8)


def test_what_differs_from_machine_to_machine_travels_in_the_memory():
    effect = effect_by_key("quadrotor", "body_drag")

    flight = racing_flight(QUADROTOR, substeps=1)

    def flown(state, action, memory):
        flying, coefficient = memory
        dragged = (*flight.simulator.effects, FittedEffect(effect, {"coefficient": coefficient}))
        simulator = flight.simulator.with_effects(dragged)
        state, flying = replace(flight, simulator=simulator).step(state, action, flying)
        return state, (flying, coefficient)

    coefficient = torch.linspace(0.0, 0.3, BATCH, dtype=torch.float64)[:, None]
    action = actions(BATCH, seed=2)
    state, memory = flown(tumbling(BATCH, seed=1), action, (None, coefficient))
    fused = FusedStep(flown, state, action, memory)
    expected = fused.pack(*flown(state, action, memory))
    torch.testing.assert_close(
        fused._graph(fused.pack(state, memory), action.T), expected, rtol=1e-9, atol=1e-7
    )


@pytest.mark.slow
def test_the_same_step_is_compiled_once_and_another_apart():
    def fused(pull: float) -> FusedStep:
        state, action = torch.ones(2, 3), torch.ones(2, 3)
        return FusedStep(lambda x, u, memory: (x + pull * u, memory), state, action, ())

    rows, action = torch.ones(3, 5), torch.full((3, 5), 2.0)
    steps = [fused(pull) for pull in (0.5, 0.5, 0.25)]
    assert [float(step(rows, action)[0, 0]) for step in steps] == [2.0, 2.0, 1.5]
    first, again, other = (step._compiled[False] for step in steps)
    assert first is again
    assert other is not first


def test_rows_and_tensors_are_the_same_numbers():
    flight = racer()
    state, memory, action = start(flight, torch.float64)
    fused = FusedStep(flight.step, state, action, memory)
    rows = fused.pack(state, memory)
    assert rows.is_contiguous()
    assert rows.shape == (fused.rows, BATCH)
    assert 100 < fused.operations < len(fused._graph.graph.nodes)
    again, kept = fused.unpack(rows)
    assert torch.equal(again, state)
    assert torch.equal(kept[0]["rate"], memory[0]["rate"])


def test_rows_that_are_not_contiguous_are_refused():
    flight = racer()
    state, memory, action = start(flight, torch.float64)
    fused = FusedStep(flight.step, state, action, memory)
    with pytest.raises(InputError, match="contiguous"):
        fused(fused.pack(state, memory), action.T)


def test_a_memory_that_does_not_exist_yet_is_refused():
    flight = racer()
    with pytest.raises(InputError, match="eager step first"):
        FusedStep(flight.step, tumbling(2, seed=1), actions(2, seed=1), None)


def test_the_component_graph_is_of_the_precision_that_is_asked_for():
    def chosen(a):
        return [torch.where(a > 0, a, torch.full_like(a, 0.1))]

    graph = component_graph(chosen, [[torch.ones(1, 2, dtype=torch.float64)]], torch.float32)
    assert graph(torch.randn(2, 5)).dtype == torch.float32
