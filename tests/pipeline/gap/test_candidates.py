import pytest

from simgap.effects import effects_of
from simgap.errors import InputError
from simgap.gap.candidates import candidates_for
from simgap.simulation import Simulator
from tests.pipeline.platforms.machines import MACHINES, some_signals

KIND = pytest.mark.parametrize("kind", list(MACHINES))


@KIND
def test_a_bundle_that_would_absorb_every_effect_does_not_compete_even_where_it_is_asked_for(kind):
    signals = some_signals(kind, (2, 10), seed=1)
    bundles = {effect.key for effect in effects_of(kind) if not effect.names_physics}
    asked = [effect.name for effect in effects_of(kind)]
    for names in (None, asked):
        chosen = {effect.key for effect in candidates_for(Simulator(MACHINES[kind]), signals, names)}
        assert chosen
        assert not chosen & bundles
        everything = {effect.key for effect in effects_of(kind) if set(effect.needs) <= set(signals)}
        assert everything - bundles <= chosen


def test_the_aerodynamics_of_a_higher_rung_are_such_bundles():
    bundles = {effect.name for effect in effects_of("quadrotor") if not effect.names_physics}
    assert bundles == {"grey_box_aerodynamics", "inflow_ratio", "tip_path_plane_flapping"}


@KIND
def test_an_effect_without_its_signals_does_not_compete(kind):
    signals = some_signals(kind, (2, 10), seed=1)
    del signals["battery_voltage"]
    chosen = candidates_for(Simulator(MACHINES[kind]), signals, None)
    assert not [effect.key for effect in chosen if "battery_voltage" in effect.needs]


def test_an_unknown_name_is_met_with_the_nearest():
    with pytest.raises(InputError, match="rotor_drag"):
        candidates_for(Simulator(MACHINES["quadrotor"]), {}, ["rotor_dragg"])
