import hashlib
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.plants import case_from_config, record_case
from simgap.plants.case import PlantCase, Sensors
from simgap.plants.rig.case import Gimbal, Pilot, RigCase
from simgap.plants.rig.sticks import Sticks
from simgap.plants.sealing import key_text
from tests.pipeline.plants.reading import assert_read_as_written


@pytest.fixture(scope="module")
def short(configured):
    return replace(configured, runs=2, duration=0.5)


@pytest.fixture(scope="module")
def recorded(short, racer):
    return record_case(short, racer, seed=3)


def test_it_is_250_seconds_at_50_hertz(configured):
    assert configured.runs * configured.duration == 250.0
    assert configured.rate == 50.0
    configured.check()


def test_the_same_seed_gives_the_same_recording_and_another_another(recorded, short, racer):
    again, other = (record_case(short, racer, seed)[0].frame for seed in (3, 4))
    pd.testing.assert_frame_equal(recorded[0].frame, again)
    assert not recorded[0].frame["body_rate_x"].equals(other["body_rate_x"])


def test_the_recording_keeps_the_contract_and_the_secret(recorded, tmp_path):
    recording, key = recorded
    assert recording.kind == "quadrotor"
    assert {f"body_rate_command_{axis}" for axis in "xyz"} <= set(recording.units)
    assert_read_as_written(recording, tmp_path)
    assert hashlib.sha256(key_text(key).encode()).hexdigest() in recording.source
    assert "gimbal" not in recording.source
    assert [entry["name"] for entry in key["outside"]] == ["gimbal", "autopilot"]


def test_it_turns_as_commanded_on_the_spot(short, racer):
    case = replace(short, runs=10, dropped=0.0, sensors=Sensors(scale=0.0))
    frame = record_case(case, racer, seed=1)[0].frame
    assert (frame[["position_x", "position_y"]] == 0.0).all(axis=None)
    assert (frame[[f"velocity_{axis}" for axis in "xyz"]] == 0.0).all(axis=None)
    force = frame[[f"specific_force_{axis}" for axis in "xyz"]].to_numpy()
    np.testing.assert_allclose(np.linalg.norm(force, axis=1), racer.gravity, rtol=1e-2)
    for axis in "xyz":
        late = frame.groupby("run")[f"body_rate_command_{axis}"].shift(6)
        assert frame[f"body_rate_{axis}"].corr(late) > 0.7


def test_commands_reach_up_to_half_the_rate_and_change_once_a_sample(configured):
    case = replace(configured, runs=1, pilot=replace(configured.pilot, hold=0.02))
    sticks = Sticks(case, 500, np.random.default_rng(0))
    command = np.stack([sticks(sample, np.eye(3)[None])[0, 0] for sample in range(500)])
    power = np.abs(np.fft.rfft(command - command.mean())) ** 2
    frequency = np.fft.rfftfreq(len(command), 1.0 / case.rate)
    assert power[frequency > 20.0].mean() > 0.3 * power[(frequency > 5.0) & (frequency < 10.0)].mean()
    assert np.abs(command).max() <= case.pilot.most


def test_packets_are_lost(recorded, short):
    share = len(recorded[0].frame) / (short.runs * short.duration * short.rate)
    assert 0.75 < share < 1.0


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (RigCase(effects={"rotor_drag": 0.3}), "record.effects.rotor_drag: does not show"),
        (RigCase(effects={"motor_lagg": 0.3}), "did you mean 'motor_lag'"),
        (RigCase(runs=0), "record.runs"),
        (RigCase(latency=-0.1), "record.latency"),
        (RigCase(dropped=1.0), "record.dropped"),
        (RigCase(gimbal=Gimbal(friction=-1.0)), "record.gimbal.friction"),
        (RigCase(gimbal=Gimbal(give=0.0)), "record.gimbal.give"),
        (RigCase(gimbal=Gimbal(rings=[0.0])), "record.gimbal.rings"),
        (RigCase(gimbal=Gimbal(skew=1.0)), "record.gimbal.skew"),
        (RigCase(pilot=Pilot(most=-1.0)), "record.pilot.most"),
    ],
)
def test_a_case_that_cannot_be_run_is_refused_by_its_key(case, message):
    with pytest.raises(InputError, match=message):
        case.check()


def test_a_plant_is_chosen_by_name(racer):
    assert isinstance(case_from_config("quadrotor", {"plant": "attitude_rig"}), RigCase)
    assert isinstance(case_from_config("quadrotor", {}), PlantCase)
    with pytest.raises(InputError, match=r"record\.plant: there is no plant 'boat'"):
        case_from_config("quadrotor", {"plant": "boat"})
