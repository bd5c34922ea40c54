import struct
import zlib
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.apply import recording_of
from simgap.logs.formats import format_of, read_log
from simgap.logs.layouts.crazyflie import propose
from simgap.logs.log import Log
from simgap.logs.mapping import mapping_from_config, mapping_to_config
from simgap.logs.readers.crazyflie import read, unpacked_quaternion
from tests.pipeline.logs.damage import assert_a_log_or_one_line, damaged
from tests.pipeline.logs.vehicle import assert_one_motion, flight

G = 9.80665
Events = Mapping[str, tuple[np.ndarray, Mapping[str, tuple[str, np.ndarray]]]]
"""Type of events to its times in ms, and variable to (letter, values)."""


def encoded(events: Events, version: int = 2, checksum: bool = True) -> bytes:
    """Return a log as the deck writes it: the events of all types by time."""
    body = struct.pack("<BHH", 0xBC, version, len(events))
    rows = []
    for number, (name, (times, variables)) in enumerate(events.items()):
        body += struct.pack("<H", number) + name.encode() + b"\0" + struct.pack("<H", len(variables))
        for variable, (letter, _) in variables.items():
            body += f"{variable}({letter})".encode() + b"\0"
        layout = "<H" + ("I" if version == 1 else "Q") + "".join(letter for letter, _ in variables.values())
        for row, time in enumerate(times):
            stamp = int(time) if version == 1 else int(time * 1000)
            values = [
                float(values[row]) if letter in "fd" else int(values[row])
                for letter, values in variables.values()
            ]
            rows.append((time, struct.pack(layout, number, stamp, *values)))
    body += b"".join(row for _, row in sorted(rows, key=lambda entry: entry[0]))
    return body + (struct.pack("<I", zlib.crc32(body)) if checksum else b"")


def written(folder: Path, content: bytes) -> Path:
    path = folder / "log00.bin"
    path.write_bytes(content)
    return path


SLOW = {"pm.vbat": ("f", np.array([4.0, 3.9]))}
FAST = {"gyro.x": ("f", np.arange(10.0)), "motor.m1": ("H", 100 * np.arange(10))}
TWO: Events = {"fixedFrequency": (10.0 * np.arange(10), FAST), "battery": (np.array([5.0, 55.0]), SLOW)}


@pytest.mark.parametrize("version", [1, 2])
def test_events_of_two_types_have_their_own_times(tmp_path: Path, version: int) -> None:
    path = written(tmp_path, encoded(TWO, version))
    assert format_of(path).name == "Crazyflie log"
    log = read_log(path)
    np.testing.assert_allclose(log.signals["gyro.x"].time, 0.01 * np.arange(10))
    np.testing.assert_array_equal(log.signals["motor.m1"].values, 100 * np.arange(10))
    np.testing.assert_allclose(log.signals["pm.vbat"].time, [0.005, 0.055])
    assert not log.remarks


def test_a_log_that_was_cut_off_has_its_whole_events(tmp_path: Path) -> None:
    log = read(written(tmp_path, encoded(TWO, checksum=False)[:-3]))
    assert len(log.signals["gyro.x"].values) == 9
    assert "cut off" in log.remarks[0]


def test_a_log_that_goes_on_with_nonsense_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="checksum is wrong"):
        read(written(tmp_path, encoded(TWO, checksum=False) + b"\xff" * 40))


def test_a_log_without_types_of_events_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="whole event"):
        read(written(tmp_path, encoded({})))


@settings(max_examples=40)
@given(content=damaged(encoded(TWO)))
def test_damage_gives_a_log_or_one_line(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    assert_a_log_or_one_line(read, tmp_path_factory.getbasetemp() / "damaged.bin", content)


def packed(quaternion: np.ndarray) -> int:
    """Return x, y, z, w as the firmware packs it."""
    largest = int(np.argmax(np.abs(quaternion)))
    quaternion = quaternion * np.sign(quaternion[largest])
    bits = largest
    for place in range(4):
        if place != largest:
            size = int(511 * abs(quaternion[place]) * np.sqrt(2) + 0.5)
            bits = bits << 10 | int(quaternion[place] < 0) << 9 | size
    return bits


@given(values=st.lists(st.floats(-1, 1), min_size=4, max_size=4))
def test_a_packed_quaternion_is_the_same_rotation(values: list[float]) -> None:
    quaternion = np.array(values)
    length = np.linalg.norm(quaternion)
    if length < 0.1:
        return
    found = unpacked_quaternion(np.array([packed(quaternion / length)], dtype="u4"))[:, 0]
    assert abs(found @ quaternion / length) == pytest.approx(1.0, abs=1e-5)


def flown(compressed: bool = False, motors: bool = True, state: bool = True, step: int = 1) -> Events:
    """The flight of the racer as a Crazyflie logs it: IMU and motors fast, the estimate at half of it."""
    frame = flight().iloc[::step]
    times = 5000 + 1000 * frame["t"].to_numpy()
    fast = {f"gyro.{axis}": ("f", np.rad2deg(frame[f"body_rate_{axis}"].to_numpy())) for axis in "xyz"}
    fast |= {f"acc.{axis}": ("f", frame[f"specific_force_{axis}"].to_numpy() / G) for axis in "xyz"}
    if motors:
        commands = {rotor: frame[f"motor_command_{rotor}"].to_numpy() for rotor in range(1, 5)}
        fast |= {f"motor.m{rotor}": ("H", np.round(65535 * values)) for rotor, values in commands.items()}
    events = {"fixedFrequency": (times, fast)}
    if state:
        events["estimate"] = times, _estimate(frame, compressed)
    return events


def _estimate(frame: object, compressed: bool) -> dict[str, tuple[str, np.ndarray]]:
    column = {name: frame[name].to_numpy() for name in frame.columns}  # type: ignore[attr-defined]
    letter, scale, head = ("h", 1000.0, "stateEstimateZ") if compressed else ("f", 1.0, "stateEstimate")
    found = {f"{head}.{axis}": (letter, np.round(scale * column[f"position_{axis}"], 6)) for axis in "xyz"}
    found |= {f"{head}.v{axis}": (letter, np.round(scale * column[f"velocity_{axis}"], 6)) for axis in "xyz"}
    if compressed:
        rotations = np.stack([column[f"attitude_{axis}"] for axis in "xyzw"], axis=1)
        found["stateEstimateZ.quat"] = "I", np.array([packed(rotation) for rotation in rotations])
    else:
        found |= {f"stateEstimate.q{axis}": ("f", column[f"attitude_{axis}"]) for axis in "wxyz"}
    return found


def log_of(folder: Path, events: Events) -> Log:
    return read(written(folder, encoded(events)))


def test_the_estimate_imu_and_motors_are_one_motion(tmp_path: Path) -> None:
    log = log_of(tmp_path, flown())
    proposal = propose(log)
    assert proposal is not None
    assert not proposal.missing
    frame = recording_of(log, proposal.mapping()).frame
    assert_one_motion(frame)
    assert frame["motor_command_1"].between(0, 1).all()
    motor = proposal.columns["motor_command_1"]
    assert motor.confidence < 0.9
    assert "square root" in motor.reason


def test_a_thrust_becomes_a_speed_as_the_mapping_says(tmp_path: Path) -> None:
    events = flown()
    log = log_of(tmp_path, events)
    speeds = recording_of(log, propose(log).mapping()).frame
    fast = dict(events["fixedFrequency"][1])
    for rotor in range(1, 5):
        fast[f"motor.m{rotor}"] = ("H", np.round(fast[f"motor.m{rotor}"][1] ** 2 / 65535))
    log = log_of(tmp_path, {**events, "fixedFrequency": (events["fixedFrequency"][0], fast)})
    content = mapping_to_config(propose(log).mapping())
    for rotor in range(1, 5):
        content[f"motor_command_{rotor}"]["root"] = True
    frame = recording_of(log, mapping_from_config(content)).frame
    commands = [f"motor_command_{rotor}" for rotor in range(1, 5)]
    np.testing.assert_allclose(frame[commands], speeds[commands], atol=1e-4)


def test_the_compressed_estimate_is_the_same(tmp_path: Path) -> None:
    log = log_of(tmp_path, flown(compressed=True))
    proposal = propose(log)
    assert proposal is not None
    columns = recording_of(log, proposal.mapping()).frame
    plain = log_of(tmp_path, flown())
    expected = recording_of(plain, propose(plain).mapping()).frame  # type: ignore[union-attr]
    for name in ("position_z", "velocity_x", "attitude_w", "attitude_y"):
        np.testing.assert_allclose(columns[name], expected[name], atol=5e-3)


@pytest.mark.parametrize(
    ("events", "said"),
    [
        (flown(state=False), "stateEstimate.x, stateEstimate.y"),
        (flown(motors=False), "motor.m1, motor.m2"),
        (flown(step=10), "too slowly"),
        ({"fixedFrequency": (10.0 * np.arange(10), FAST | {f"motor.m{m}": ("H", np.zeros(10)) for m in (1, 2, 3, 4)})},
         "never change"),
    ],
)  # fmt: skip
def test_what_is_missing_is_said(tmp_path: Path, events: Events, said: str) -> None:
    proposal = propose(log_of(tmp_path, events))
    assert proposal is not None
    assert said in " ".join([proposal.refusal, *proposal.missing.values()])


def test_real_logs_have_flights_but_no_state(shared_data: Path) -> None:
    log = read_log(shared_data / "crazyflie_thrust_lag" / "log15")
    proposal = propose(log)
    assert proposal is not None
    assert [span.name for span in proposal.windows] == ["flight_1"]
    assert 40 < proposal.windows[0].end - proposal.windows[0].begin < 45
    assert "stateEstimate.x" in proposal.missing["position_x"]
