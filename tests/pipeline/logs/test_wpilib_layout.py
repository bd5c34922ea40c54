"""Logs of FRC robots as recordings: swerve drives, single axes and tests of SysId, or how to log what is missing."""

import contextlib
import json
import re
import struct
from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.formats import read_log
from simgap.logs.mapping import mapping_from_config, mapping_to_config
from simgap.logs.opening import open_recording
from simgap.logs.proposal import Proposal, propose
from simgap.logs.ratio import with_ratios
from simgap.recordings.opposites import named_opposites
from tests.pipeline.logs.wpilog_encoder import Writer, unit

_ROWS = [[0.1 * k, 1e9, -0.5 * k, 2.0] for k in range(5)]
_SMALL_FILE = json.dumps({"fast-forward": _ROWS, "units": "Meters", "unitsPerRotation": 0.3}).encode()
GEAR, WHEEL = 6.75, 0.05
ROBOT = {"drive": {"gear_ratio": GEAR}, "steer": {"gear_ratio": 20.0}, "wheel_radius": WHEEL}
TIME = 0.02 * np.arange(400)
SPEED = np.where((TIME > 2.0) & (TIME < 3.0), 0.0, 40.0 * np.sin(2.0 * TIME))  # of a wheel, rad/s


def _on_change(log: Writer, name: str, values: np.ndarray, metadata: str = "") -> None:
    changed = np.append(True, np.diff(values) != 0.0)
    log.doubles(name, TIME[changed], values[changed], metadata)


def _advantage_kit(corners: bool = False, motor_speed: bool = False, volts: str = "AppliedVolts") -> Writer:
    log = Writer()
    names = (
        ("FrontLeft", "FrontRight", "BackLeft", "BackRight")
        if corners
        else tuple(f"Module{n}" for n in range(4))
    )
    for number, name in enumerate(names, 1):
        wheel = number * 0.25 * SPEED
        _on_change(log, f"/Drive/{name}/DriveVelocityRadPerSec", wheel * (GEAR if motor_speed else 1.0))
        _on_change(log, f"/Drive/{name}/Drive{volts}", 12.0 / 90.0 * wheel)
        _on_change(log, f"/Drive/{name}/Turn{volts}", np.where(TIME > 1.0, 2.0, 1.0))
        _on_change(log, f"/Drive/{name}/TurnVelocityRadPerSec", np.cos(TIME) * number)
        _on_change(log, f"/Drive/{name}/TurnAbsolutePosition", np.full(400, 9.0), unit("radians"))
        _on_change(log, f"/Drive/{name}/TurnPosition", np.sin(TIME) * number, unit("radians"))
        _on_change(log, f"/RealOutputs/Drive/{name}/DriveVelocitySetpointRadPerSec", 3.0 * wheel)
    _on_change(log, "/SystemStats/BatteryVoltage", 12.0 - 0.01 * np.abs(SPEED))
    log.record(log.start("/DriverStation/Enabled", "boolean"), 0, b"\1")
    return log


@pytest.mark.parametrize("corners", [False, True])
def test_a_swerve_drive_of_advantage_kit(tmp_path: Path, corners: bool) -> None:
    path = _advantage_kit(corners).write(tmp_path / "a.wpilog")
    frame = open_recording(path, "swerve", platform=ROBOT).frame
    at = np.searchsorted(TIME, frame["t"] + 1e-6) - 1
    assert len(frame) > 300
    for number in range(1, 5):
        np.testing.assert_allclose(frame[f"drive_velocity_{number}"], GEAR * number * 0.25 * SPEED[at])
        np.testing.assert_allclose(frame[f"drive_voltage_{number}"], 12.0 / 90.0 * number * 0.25 * SPEED[at])
        np.testing.assert_allclose(frame[f"steer_angle_{number}"], number * np.sin(TIME[at]))
        np.testing.assert_array_equal(frame[f"steer_voltage_{number}"], np.where(TIME[at] > 1.0, 2.0, 1.0))
    assert frame["battery_voltage"].between(11.6, 12.0).all()


def test_an_angle_that_wraps_is_interpolated_the_short_way(tmp_path: Path) -> None:
    log = _advantage_kit()
    turned = 1.5 * TIME
    log.doubles("/Swerve/FrontLeft/SteerAngleRad", TIME + 0.007, np.arctan2(np.sin(turned), np.cos(turned)))
    own = tmp_path / "mine.yaml"
    proposed = propose(read_log(log.write(tmp_path / "a.wpilog")), "swerve").mapping()
    content = mapping_to_config(proposed) | {"steer_angle_1": {"from": "/Swerve/FrontLeft/SteerAngleRad"}}
    own.write_text(yaml.safe_dump(content))
    frame = open_recording(tmp_path / "a.wpilog", "swerve", own, ROBOT).frame
    expected = 1.5 * (frame["t"] - frame["t"].iloc[0])
    error = np.exp(1j * (frame["steer_angle_1"] - expected))
    assert np.abs(np.angle(error / error.iloc[0])).max() < 0.01


def test_the_speed_of_a_motor_is_not_geared_again(tmp_path: Path) -> None:
    path = _advantage_kit(motor_speed=True).write(tmp_path / "a.wpilog")
    columns = propose(read_log(path), "swerve").columns
    assert columns["drive_velocity_1"].source.ratio is None


def test_a_ratio_needs_a_platform(tmp_path: Path) -> None:
    path = _advantage_kit().write(tmp_path / "a.wpilog")
    with pytest.raises(InputError, match=r"drive.gear_ratio of the platform is needed"):
        open_recording(path, "swerve")
    with pytest.raises(InputError, match=r"the platform has no number drive.gear_ratio"):
        open_recording(path, "swerve", platform={"drive": {}})


@pytest.mark.parametrize(
    ("ratio", "expected"),
    [
        ("drive.gear_ratio", GEAR),
        ("drive.gear_ratio / wheel_radius", GEAR / WHEEL),
        ("wheel_radius*steer.gear_ratio", WHEEL * 20.0),
    ],
)
def test_a_ratio_is_a_product_of_numbers_of_the_platform(ratio: str, expected: float) -> None:
    mapping = mapping_from_config(
        {"kind": "swerve", "drive_velocity_1": {"from": "v", "scale": 2, "ratio": ratio}}
    )
    assert with_ratios(mapping, ROBOT).columns["drive_velocity_1"].scale == pytest.approx(2.0 * expected)


@pytest.mark.parametrize("ratio", ["2 * drive.gear_ratio", "drive.", "__import__('os')", "drive", ""])
def test_a_ratio_that_names_no_number_is_refused(ratio: str) -> None:
    mapping = mapping_from_config({"kind": "swerve", "drive_velocity_1": {"from": "v", "ratio": ratio}})
    with pytest.raises(InputError):
        with_ratios(mapping, ROBOT)


def test_measured_states_are_no_targets_and_a_turn_to_the_left_is_positive(tmp_path: Path) -> None:
    log = Writer()
    places = [
        (0.3, 0.3),
        (0.3, -0.3),
        (-0.3, 0.3),
        (-0.3, -0.3),
    ]  # m, of a robot that turns left about its middle
    rate = 2.0
    velocities = [(-rate * y, rate * x) for x, y in places]
    for name, factor in (("ModuleStates", 1.0), ("ModuleTargets", 5.0)):
        number = log.start(f"NT:/DriveState/{name}", "struct:SwerveModuleState[]")
        for step in range(60):
            states = [(factor * np.hypot(*v) * step / 60, np.arctan2(v[1], v[0])) for v in velocities]
            log.double(number, 20_000 * step, *(float(value) for state in states for value in state))
    speeds = log.start("NT:/DriveState/Speeds", "struct:ChassisSpeeds")
    for step in range(60):
        log.double(speeds, 20_000 * step, 0.0, 0.0, rate * step / 60)
    read = read_log(log.write(tmp_path / "a.wpilog"))
    proposal = propose(read, "swerve")
    chassis = read.signals[proposal.columns["chassis_rate"].source.signal].values
    total = 0.0
    for number, (x, y) in enumerate(places, 1):
        speed = proposal.columns[f"drive_velocity_{number}"].source
        assert (speed.signal, speed.ratio) == (
            f"NT:/DriveState/ModuleStates[{number - 1}]/speed",
            "drive.gear_ratio / wheel_radius",
        )
        angle = read.signals[proposal.columns[f"steer_angle_{number}"].source.signal].values[-1]
        over_floor = read.signals[speed.signal].values[-1]
        total += (x * np.sin(angle) - y * np.cos(angle)) * over_floor / (x * x + y * y) / 4
    assert total == pytest.approx(chassis[-1])
    assert total > 0
    assert "getMotorVoltage()" in proposal.missing["drive_voltage_1"]


def test_a_duty_is_no_voltage(tmp_path: Path) -> None:
    proposal = propose(
        read_log(_advantage_kit(volts="AppliedPercentage").write(tmp_path / "a.wpilog")), "swerve"
    )
    assert not proposal.is_sure
    source = proposal.columns["drive_voltage_2"].source
    assert (source.signal, source.times) == (
        "/Drive/Module1/DriveAppliedPercentage",
        "/SystemStats/BatteryVoltage",
    )
    log = Writer()
    _on_change(log, "/Drive/Module0/DriveVelocityRadPerSec", SPEED)
    _on_change(log, "/Drive/Module0/DriveDutyCycle", SPEED / 90.0)
    missing = propose(read_log(log.write(tmp_path / "b.wpilog")), "swerve").missing
    assert missing["drive_voltage_1"].startswith(
        "/Drive/Module0/DriveDutyCycle is a duty, and a duty is no voltage"
    )


def _sysid(motors: tuple[str, ...], units: tuple[str, str] = ("Rotation", "Rotation per Second")) -> Writer:
    log = Writer()
    state = log.start("sysid-test-state-drive", "string")
    tests = ("quasistatic-forward", "quasistatic-reverse", "dynamic-forward", "dynamic-reverse")
    entries = {
        (motor, name): log.start(f"{name}-{motor}-drive", "double", text)
        for motor in motors
        for name, text in (("voltage", "Volt"), ("position", units[0]), ("velocity", units[1]))
    }
    for place, test in enumerate(tests):
        sign = 1.0 if test.endswith("forward") else -1.0
        for step in range(100):
            now = 5_000_000 * place + 20_000 * step
            log.text(state, now, test)
            volts = sign * 0.05 * step if test.startswith("quasi") else sign * 4.0
            for order, motor in enumerate(motors):
                for name, value in (
                    ("voltage", volts),
                    ("position", sign * step),
                    ("velocity", sign * order + step),
                ):
                    now += 30  # µs: a program writes one value after the other
                    log.double(entries[motor, name], now, value)
        log.text(state, now + 100, "none")
    return log


def test_a_sysid_routine_is_a_joint_with_a_run_for_each_test(tmp_path: Path) -> None:
    path = _sysid(("arm",)).write(tmp_path / "a.wpilog")
    recording = open_recording(path, "joint")
    assert recording.runs == [
        "quasistatic-forward",
        "quasistatic-reverse",
        "dynamic-forward",
        "dynamic-reverse",
    ]
    run = recording.frame[recording.frame["run"] == "quasistatic-forward"].reset_index()
    np.testing.assert_allclose(run["position"][5:90], 2.0 * np.pi * run.index[5:90], rtol=2e-3)
    np.testing.assert_allclose(run["voltage"][5:90], 0.05 * run.index[5:90], rtol=1e-9)
    assert named_opposites(recording.runs) == {
        ("quasistatic-forward", "quasistatic-reverse"),
        ("dynamic-forward", "dynamic-reverse"),
    }


def test_each_motor_of_a_drivetrain_has_its_own_runs(tmp_path: Path) -> None:
    path = _sysid(("left", "right"), ("Meter", "Meter per Second")).write(tmp_path / "a.wpilog")
    recording = open_recording(path, "joint")
    assert len(recording.runs) == 8
    assert recording.units["position"] == "m"
    assert ("dynamic-forward-right", "dynamic-reverse-right") in named_opposites(recording.runs)
    right = recording.frame[recording.frame["run"] == "dynamic-forward-right"].reset_index()
    np.testing.assert_allclose(right["velocity"], 1.0 + right.index)
    assert (right["voltage"] == 4.0).all()


def test_without_a_unit_a_person_is_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    path = _sysid(("arm",), ("", "")).write(tmp_path / "a.wpilog")
    with pytest.raises(InputError, match="the log says no unit") as refused:
        open_recording(path, "joint")
    assert "mapping=a.wpilog.mapping.yaml" in str(refused.value)


def test_one_axis_of_many_is_proposed_but_not_taken(tmp_path: Path) -> None:
    log = Writer()
    for name, size in (("Arm", 1.0), ("Wrist", 0.1)):
        _on_change(log, f"/{name}/AppliedVolts", size * np.cos(TIME))
        _on_change(log, f"/{name}/PositionRad", size * np.sin(TIME))
        _on_change(log, f"/{name}/VelocityRadPerSec", size * np.cos(TIME))
    proposal = propose(read_log(log.write(tmp_path / "a.wpilog")), "joint")
    assert proposal.columns["voltage"].source.signal == "/Arm/AppliedVolts"
    assert not proposal.is_sure
    assert "Wrist" in " ".join(proposal.notes)


def _of_a_file(shared_data: Path, file: str, kind: str) -> Proposal:
    return propose(read_log(shared_data / "raw" / file), kind)


def test_a_real_swerve_drive_without_volts(shared_data: Path) -> None:
    proposal = _of_a_file(shared_data, "wpilog_swerve_match_tan560/FRC_20240910_002841.wpilog", "swerve")
    assert not proposal.refusal
    assert {"steer_angle_1", "steer_angle_2", "steer_angle_4", "chassis_rate"} <= set(proposal.columns)
    lost = {
        f"{name}_{n}" for name in ("drive_voltage", "steer_voltage", "steer_velocity") for n in range(1, 5)
    }
    assert set(proposal.missing) == lost | {"drive_velocity_3", "steer_angle_3"}
    with pytest.raises(
        InputError,
        match=r"no signal for 'drive_voltage_1..4', 'steer_voltage_1..4', .*log the volts of each motor",
    ):
        open_recording(
            shared_data / "raw" / "wpilog_swerve_match_tan560/FRC_20240910_002841.wpilog", "swerve"
        )


@pytest.mark.parametrize(
    ("file", "kind", "said"),
    [
        (
            "wpilog_misc_devs/FRC_20220421_181140_GALILEO_Q28",
            "swerve",
            "no module of a swerve drive was logged",
        ),
        (
            "wpilog_misc_devs/FRC_20220701_010412",
            "joint",
            "Left Motor Speed is a duty, and a duty is no voltage",
        ),
        (
            "wpilog_misc_devs/FRC_20220701_010412",
            "swerve",
            "Left Motor Speed is a duty, and a duty is no voltage",
        ),
        ("wpilog_akit_sim_husky/Log_23-06-23_19-38-49", "swerve", "do not move"),
    ],
)
def test_logs_that_are_no_recordings_are_refused(shared_data: Path, file: str, kind: str, said: str) -> None:
    with pytest.raises(InputError, match=re.escape(said)):
        open_recording(shared_data / "raw" / f"{file}.wpilog", kind)


def _sysid_file(path: Path, scale: float) -> Path:
    time = np.arange(0.0, 2.0, 0.005)
    volts = np.full(len(time), 6.0)
    velocity = scale * 2.0 * (1.0 - np.exp(-time / 0.1))
    position = scale * 2.0 * (time - 0.1 * (1.0 - np.exp(-time / 0.1)))
    rows = np.column_stack([time, volts, volts, position, position, velocity, velocity, 0 * time, 0 * time])
    mirrored = rows * np.array([1, -1, -1, -1, -1, -1, -1, 1, 1])
    content = {"fast-forward": rows.tolist(), "fast-backward": mirrored.tolist()}
    path.write_text(json.dumps(content | {"units": "Meters", "unitsPerRotation": 0.3}))
    return path


def test_a_sysid_file_with_two_readings_asks_and_takes_the_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    path = _sysid_file(tmp_path / "data.json", 1.0)
    with pytest.raises(InputError, match=r"rotations \(1.2 m/s at 12 V\) or meters \(4 m/s at 12 V\)"):
        open_recording(path, "joint")
    written = tmp_path / "data.json.mapping.yaml"
    assert "For rotations (1.2 m/s at 12 V): scale 0.3 of position" in written.read_text()
    recording = open_recording(path, "joint", written)
    assert recording.runs == [
        f"fast-{way}-{side}" for way in ("forward", "backward") for side in ("left", "right")
    ]
    assert recording.frame["velocity"].max() == pytest.approx(2.0, rel=1e-3)


def test_a_sysid_file_that_says_its_unit_is_read(tmp_path: Path) -> None:
    recording = open_recording(_sysid_file(tmp_path / "data.json", 5.0), "joint")  # 20 m/s, were it metres
    assert recording.frame["velocity"].max() == pytest.approx(5.0 * 2.0 * 0.3, rel=1e-3)


def _damaged(content: bytes, end: float, flips: list[tuple[float, int]]) -> bytes:
    damaged = bytearray(content)
    for place, change in flips:
        damaged[int(place * (len(content) - 1))] ^= change
    return bytes(damaged[: int(end * len(content))])


@settings(max_examples=50)
@given(
    end=st.one_of(st.just(1.0), st.floats(0.0, 1.0)),
    flips=st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(1, 255)), max_size=3),
)
def test_a_damaged_sysid_file_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, end: float, flips: list[tuple[float, int]]
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.json"
    path.write_bytes(_damaged(_SMALL_FILE, end, flips))
    with contextlib.suppress(InputError):
        propose(read_log(path), "joint")


def test_of_a_record_with_several_values_all_are_of_one_sample(tmp_path: Path) -> None:
    log = Writer()
    states = log.start("/Arm/State", "struct:Pose2d")
    for step in range(50):
        log.record(states, 20_000 * step, struct.pack("<3d", step, 0.0, 0.0))
    signals = read_log(log.write(tmp_path / "a.wpilog")).signals
    np.testing.assert_array_equal(
        signals["/Arm/State/translation/x"].time, signals["/Arm/State/rotation/value"].time
    )
