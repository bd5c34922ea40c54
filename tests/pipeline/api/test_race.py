"""`simgap/Race-v0`."""

import sys

import gymnasium
import numpy as np
import pytest
import yaml
from gymnasium.utils.env_checker import check_env

import simgap.api.race as races
from simgap.api.registration import register_environments
from simgap.api.simulators import build_simulator
from simgap.artifacts import CONFIGURATION
from simgap.errors import InputError
from simgap.simulation import write_simulator
from tests.pipeline.platforms.machines import JOINT, QUADROTOR

register_environments()
# Fewer and simpler inner steps than a race has: they are compiled sooner.
COARSE = {"flying": {"substeps": 2, "integrator": "euler", "powertrain": False}, "episode_steps": 40}


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*Box observation space:UserWarning")
def test_gymnasium_makes_a_race_in_a_saved_simulator_and_finds_nothing_wrong(tmp_path):
    machine = build_simulator(QUADROTOR, {"rotor_drag": {}, "motor_lag": {}})
    write_simulator(machine.simulator, tmp_path / "simulator")
    environment = gymnasium.make(races.ID, simulator=str(tmp_path), track="figure_eight", settings=COARSE)
    check_env(environment.unwrapped, skip_render_check=True)
    seen, _ = environment.reset(seed=3)
    assert seen.shape == environment.observation_space.shape
    total, over = 0.0, False
    for _ in range(COARSE["episode_steps"]):
        _, reward, terminated, truncated, _ = environment.step(np.zeros(4, np.float32))
        total, over = total + reward, over or terminated or truncated
    assert over
    assert np.isfinite(total)
    again, _ = environment.reset(seed=3)
    np.testing.assert_array_equal(again, seen)


@pytest.mark.parametrize("track", ["tiny", "path", "keys"])
def test_a_machine_races_on_a_track_by_name_by_path_or_by_its_keys(track, tmp_path):
    keys = yaml.safe_load((CONFIGURATION / "track" / "tiny.yaml").read_text())
    (tmp_path / "mine.yaml").write_text(yaml.safe_dump(keys))
    given = {"tiny": "tiny", "path": tmp_path / "mine.yaml", "keys": keys}[track]
    machine = build_simulator(QUADROTOR, {"rotor_drag": {"coefficient": 0.5}})
    environment = races.race(machine, given, COARSE)
    assert len(environment.environment.track) == 4
    fitted = environment.environment.fleet.flight.simulator.effects
    assert {effect.effect.name for effect in fitted} == {"rotor_drag"}


def test_a_platform_races_by_its_name():
    flight = races.race("racer", "tiny").environment.fleet.flight
    assert [fitted.effect.name for fitted in flight.simulator.effects] == ["powertrain"]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ({"track": "tinny"}, "track: there is no 'tinny'; did you mean 'tiny'?"),
        ({"simulator": "nowhere"}, "platform: there is no"),
        ({"simulator": JOINT}, "a joint cannot race"),
        ({"settings": {"flying": {"substep": 2}}}, "flying: unknown key 'substep'; did you mean 'substeps'?"),
        ({"track": {"gates": []}}, "has fewer than two gates"),
    ],
)
def test_what_cannot_be_raced_is_refused(arguments, line):
    with pytest.raises(InputError) as refused:
        gymnasium.make(races.ID, **{"track": "tiny", **arguments})
    assert line in str(refused.value)


def test_an_effect_that_nothing_drives_is_left_out_with_a_warning():
    with pytest.warns(UserWarning, match="battery_sag is left out"):
        races.race(build_simulator(QUADROTOR, {"battery_sag": {}}), "tiny", COARSE)


def test_what_is_not_installed_is_said_with_the_command_that_installs_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "simgap.policies.gymnasium_adapter", raising=False)
    with pytest.raises(InputError) as refused:
        races.race()
    assert str(refused.value) == "needs gymnasium; pip install 'simgap[race]'"
