"""What a fit asks for again is kept, and nothing else is taken for it."""

import pytest
import torch

from simgap.effects import effect_by_key
from simgap.equations.recent import Recent
from simgap.equations.residuals import Inside, signals_inside
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.problems import blocks_of
from tests.pipeline.gap.recordings import flight, racer


def fitted(name: str, *values: float) -> FittedEffect:
    effect = effect_by_key("quadrotor", name)
    return FittedEffect(effect, {p.name: v for p, v in zip(effect.parameters, values, strict=True)})


def test_a_result_is_made_once_for_the_same_values():
    recent, made = Recent[int](2), []

    def result(*effects: FittedEffect) -> int:
        return recent.of(effects, lambda: made.append(effects) or len(made))

    drag, more = fitted("rotor_drag", 0.3), fitted("rotor_drag", 0.4)
    assert [result(drag), result(more), result(fitted("rotor_drag", 0.3))] == [1, 2, 1]
    assert result(drag, more) == 3
    assert result(drag) == 4  # the third one took its place


@pytest.mark.parametrize(
    "effects",
    [
        (fitted("motor_lag", 0.03, 1.3), fitted("rotor_drag", 0.3)),
        (fitted("motor_lag", 0.04, 1.3), fitted("rotor_drag", 0.3)),
        (fitted("command_scale_error", 1.1), fitted("slung_payload", 0.1, 0.5)),
        (fitted("command_scale_error", 1.1), fitted("slung_payload", 0.1, 0.4)),
        (fitted("mass_error", 1.1), fitted("body_drag", 0.02, 0.0)),
        (),
    ],
)
def test_signals_from_memory_are_those_of_the_simulator(effects):
    simulator = Simulator(racer(), effects)
    blocks = blocks_of(flight(), simulator)
    inside = Inside(blocks)
    inside(Simulator(racer(), (fitted("motor_lag", 0.03, 1.3), fitted("rotor_drag", 0.1))))
    inside(Simulator(racer(), (fitted("command_scale_error", 1.1), fitted("slung_payload", 0.1, 0.5))))
    for _ in range(2):
        found, expected = inside(simulator), signals_inside(simulator, blocks, blocks.acting)
        assert found.keys() == expected.keys()
        for name, series in expected.items():
            torch.testing.assert_close(found[name], series, rtol=0.0, atol=0.0)


def test_a_force_changes_nothing_before_it():
    blocks = blocks_of(flight(), Simulator(racer()))
    inside, lag = Inside(blocks), fitted("motor_lag", 0.03, 1.3)
    first, second = (inside(Simulator(racer(), (lag, fitted("rotor_drag", drag)))) for drag in (0.1, 0.4))
    assert first is second
