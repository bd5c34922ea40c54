"""Betaflight logs as recordings: frames by physics, flights, what is refused, and a whole diagnosis."""

import functools
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from simgap.logs.formats import read_log
from simgap.logs.layouts.betaflight import propose
from simgap.logs.layouts.powered import flights_of
from simgap.logs.listing import log_lines
from simgap.logs.log import Log, Signal, Span
from simgap.logs.opening import open_recording
from tests.pipeline.logs.layouts.blackbox_flights import SIGNS, blackbox_of, order_of

RACER = yaml.safe_load((Path(__file__).parents[4] / "conf/platform/racer.yaml").read_text())
STEP = 0.002  # s


@functools.cache
def own_flight(reversed_motors: bool = False, seconds: float = 6.0, runs: int = 1) -> pd.DataFrame:
    """Return flights of a rigid body that four rotors of 30 ms turn, in the columns of the contract.

    A pilot rolls right, pitches down and yaws left in turns; the rates follow the torques of the rotors alone.
    """
    turn = np.array([1.0, -1.0, -1.0, 1.0]) * (-1.0 if reversed_motors else 1.0)
    lever = np.array(SIGNS, dtype=float)
    mixer = np.stack([lever[:, 1], -lever[:, 0], turn])
    frames = []
    for run in range(runs):
        random = np.random.default_rng(run)
        time = np.arange(0.0, seconds, STEP)
        wave = random.uniform(2.0, 12.0, (3, 4)), random.uniform(0.0, 6.0, (3, 4))
        wanted = np.sin(wave[0][..., None] * time + wave[1][..., None]).sum(1)  # (3, samples), rad/s
        rate, thrust, kept = np.zeros(3), np.full(4, 0.25), []
        for place in range(len(time)):
            asked = np.clip(0.25 + 0.03 * (wanted[:, place] - rate) @ mixer, 0.01, 1.0)
            thrust = thrust + STEP / 0.03 * (asked - thrust)
            kept.append([*rate, *np.sqrt(asked), 9.81 * thrust.sum()])
            rate = rate + STEP * np.array([40.0, 35.0, 12.0]) * (mixer @ thrust)
        columns = [f"body_rate_{axis}" for axis in "xyz"] + [f"motor_command_{n}" for n in range(1, 5)]
        frame = pd.DataFrame(kept, columns=[*columns, "specific_force_z"])
        frames.append(frame.assign(run=f"run {run}", t=time, specific_force_x=0.1, specific_force_y=-0.1))
    return pd.concat(frames, ignore_index=True).assign(battery_voltage=15.0)


def proposal_of(folder: Path, content: bytes):
    path = folder / "log.bbl"
    path.write_bytes(content)
    return propose(read_log(path), None)


@pytest.mark.slow
def test_columns_come_out_as_they_were_flown(tmp_path):
    flown = own_flight(seconds=3.5, runs=2)
    (tmp_path / "log.bbl").write_bytes(blackbox_of(flown))
    recording = open_recording(tmp_path / "log.bbl", "quadrotor", None)
    assert recording.runs == ["flight 1", "flight 2"]
    first = recording.frame[recording.frame["run"] == "flight 1"]
    step = float(np.median(np.diff(first["t"])))
    assert step == pytest.approx(0.005)
    # half a second at both ends is left out, and five samples of two milliseconds make two of five
    truth = flown[flown["run"] == "run 0"]
    at = 0.5 + first["t"].to_numpy()
    for column, resolution in {
        "body_rate_x": 0.02, "body_rate_y": 0.02, "body_rate_z": 0.02, "motor_command_1": 5e-3,
        "motor_command_4": 5e-3, "specific_force_z": 0.1, "battery_voltage": 0.01,
    }.items():  # fmt: skip
        expected = np.interp(at, truth["t"], truth[column])
        error = np.abs(first[column].to_numpy() - expected)
        assert np.median(error) < resolution, column
    assert any("Position, velocity and attitude were not recorded" in said for said in recording.warnings)


@pytest.mark.parametrize("reversed_motors", [False, True])
def test_the_log_tells_which_way_the_motors_turn(tmp_path, reversed_motors):
    proposal = proposal_of(tmp_path, blackbox_of(own_flight(reversed_motors)))
    assert proposal.is_sure
    said = "[-1, 1, 1, -1]" if reversed_motors else "[1, -1, -1, 1]"
    other = "[1, -1, -1, 1]" if reversed_motors else "[-1, 1, 1, -1]"
    (note,) = (note for note in proposal.notes if "rotor_directions" in note)
    assert said in note
    assert other not in note


def test_the_log_tells_how_strong_the_rotors_are(tmp_path):
    """A rotor of the flights above gives 9.81 m/s² at full command, and 30 ms of lag hardly change that."""
    (note,) = (n for n in proposal_of(tmp_path, blackbox_of(own_flight())).notes if "motor_speed_max²" in n)
    assert float(note.split(" near ")[1].split()[0]) == pytest.approx(9.81, rel=0.05)


def test_rates_that_oppose_the_motors_are_not_sure(tmp_path):
    flown = own_flight()
    proposal = proposal_of(tmp_path, blackbox_of(flown.assign(body_rate_y=-flown["body_rate_y"])))
    assert not proposal.is_sure
    assert proposal.columns["body_rate_y"].confidence < 0.5
    assert proposal.columns["body_rate_x"].confidence > 0.9


def test_rotor_speeds_come_from_the_electrical_ones(tmp_path):
    flown = own_flight()
    speeds = {f"motor_speed_{n}": 1500.0 * flown[f"motor_command_{n}"] for n in range(1, 5)}
    (tmp_path / "log.bbl").write_bytes(blackbox_of(flown.assign(**speeds)))
    frame = open_recording(tmp_path / "log.bbl", "quadrotor", None).frame
    np.testing.assert_allclose(frame["motor_speed_2"], 1500.0 * frame["motor_command_2"], atol=8.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda f: f.assign(**{f"motor_command_{n}": 0.04 for n in range(1, 5)}), "no flight is in it"),
        (lambda f: f[f["t"] < 2.0], "no flight is in it"),
    ],
)
def test_a_log_without_a_flight_is_refused(tmp_path, change, said):
    proposal = proposal_of(tmp_path, blackbox_of(change(own_flight())))
    assert said in proposal.refusal
    shown = "\n".join(log_lines(read_log(tmp_path / "log.bbl"), proposal))
    assert "motor[0]" in shown
    assert "missing" not in shown


def test_a_wing_and_another_kind_are_refused(tmp_path):
    log = Log("Blackbox", "log", {name: Signal(name, np.arange(9.0), np.zeros(9)) for name in ("motor[0]",)})
    assert "has 1 motors" in propose(log, None).refusal
    assert propose(Log("table", "log", {}), None) is None
    content = blackbox_of(own_flight())
    (tmp_path / "log.bbl").write_bytes(content)
    assert "only flights of quadrotors" in propose(read_log(tmp_path / "log.bbl"), "joint").refusal


def test_flights_leave_out_the_ground_and_bridge_a_dip():
    time = np.arange(0.0, 30.0, 0.01)
    command = np.full((len(time), 4), 0.3)
    command[(time < 3.0) | (time > 27.0)] = 0.06
    command[(time > 10.0) & (time < 10.5)] = 0.06  # a flip without throttle
    command[(time > 15.0) & (time < 18.0)] = 0.06  # on the ground between two flights
    log = Log("Blackbox", "log", {}, spans=(Span("log 1", 0.0, 30.0),))
    found = flights_of(log, time, command)
    assert len(found) == 2
    for flight, (begin, end) in zip(found, ((3.0, 15.0), (18.0, 27.0)), strict=True):
        assert begin < flight.begin < begin + 0.6
        assert end - 0.6 < flight.end < end


def test_real_flights(shared_data):
    folder = shared_data / "raw" / "blackbox_fc_blackbox"
    assert "no flight is in it" in propose(read_log(folder / "btfl_001.bbl"), None).refusal
    for name, flights in (("LOG00037.BFL", 1), ("btfl_002.bbl", 4), ("btfl_all.bbl", 3)):
        proposal = propose(read_log(folder / name), None)
        assert proposal.is_sure
        assert len(proposal.windows) == flights
        assert any("[-1, 1, 1, -1]" in note for note in proposal.notes)


def test_a_turn_to_the_left_is_a_positive_yaw_rate(shared_data):
    """Drag stays behind in the world while the body yaws: seen from the body it turns the other way, da/dt = −ω × a."""
    from scipy.signal import butter, sosfiltfilt

    recording = open_recording(
        shared_data / "raw" / "blackbox_fc_blackbox" / "btfl_all.bbl", "quadrotor", None
    )
    run = recording.frame[recording.frame["run"] == "flight 2"]
    assert run["specific_force_z"].median() > 8.0  # thrust is up
    assert run["specific_force_x"].median() < -1.0  # flown forward, against the air
    step = float(np.median(np.diff(run["t"])))
    slow = butter(2, 1.0, "low", fs=1 / step, output="sos")
    along, across, turn = (
        sosfiltfilt(slow, run[name].to_numpy())
        for name in ("specific_force_x", "specific_force_y", "body_rate_z")
    )
    assert np.corrcoef(np.gradient(across, step), -turn * along)[0, 1] > 0.3
    assert np.corrcoef(np.gradient(along, step), turn * across)[0, 1] > 0.3


@pytest.mark.slow(minutes=1)
def test_sag_and_lag_are_named_in_a_log_without_a_position(tmp_path):
    """A concealed quadrotor, logged as Betaflight does: whole degrees per second, and no state."""
    from simgap.api.flow import diagnosed, nominal_simulator
    from simgap.gap.settings import Gap
    from simgap.platforms.settings import SimulatorSettings
    from simgap.recordings.cleaning.settings import Cleaning
    from simgap.recordings.split import Split
    from tests.pipeline.gap.recordings import flown

    truth = {"battery_sag": 1.0, "motor_lag": 0.03}
    flights = flown(tuple(truth.items()), seed=0, runs=8)
    order = order_of(RACER["rotor_positions"])
    (tmp_path / "log.bbl").write_bytes(blackbox_of(flights.frame.filter(regex="^(?!motor_speed)"), order))
    recording = open_recording(tmp_path / "log.bbl", "quadrotor", None)
    platform = RACER | {
        key: [RACER[key][rotor] for rotor in order] for key in ("rotor_positions", "rotor_directions")
    }
    nominal = nominal_simulator(recording, platform, SimulatorSettings())
    found = diagnosed(recording, nominal, Gap(resamples=50, horizon=0.1), Cleaning(), Split()).diagnosis
    assert found.verdict == "missing_physics"
    assert {named.effect.key for named in found.naming.named if named.probability > 0.5} == set(truth)
    for fitted in found.simulator.free:
        first = next(iter(fitted.values.values()))
        assert first == pytest.approx(truth[fitted.effect.key], rel=0.1)
    assert found.validation.gap_closed > 0.9
    assert {channel.name for channel in found.channels} == {"force_z", "torque_x", "torque_y", "torque_z"}
