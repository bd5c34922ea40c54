"""Large logs of each format, as `benchmarks.reading` reads them: a joint that swings, a quadrotor that sways.

They are written by the encoders of the tests, and not by what reads them.
"""

import json
import struct
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq

from simgap.recordings.recording import recording_from_frame, write_recording
from tests.pipeline.logs import bag_writer
from tests.pipeline.logs.dataflash_encoder import dataflash
from tests.pipeline.logs.layouts.blackbox_flights import blackbox_of
from tests.pipeline.logs.ulog_encoder import ulog
from tests.pipeline.logs.wpilog_encoder import Writer

RATE = 250.0  # Hz
_G = 9.80665
_ON_GROUND = 250  # samples before and after a flight


def joint(rows: int) -> pd.DataFrame:
    """Return a joint that is driven along two sines; one run."""
    time = np.arange(rows) / RATE
    waves, rates = np.array([[0.8], [0.5]]), np.array([[1.3], [3.1]])
    position = (waves * np.sin(rates * time)).sum(axis=0)
    velocity = (waves * rates * np.cos(rates * time)).sum(axis=0)
    effort = -(0.02 * waves * rates**2 * np.sin(rates * time)).sum(axis=0) + 0.1 * velocity
    noise = np.random.default_rng(0).normal(0.0, 1.0, (2, rows))
    columns = {"run": "run", "t": time, "position": position + 1e-4 * noise[0]}
    return pd.DataFrame(columns | {"velocity": velocity + 1e-3 * noise[1], "effort": effort})


def quadrotor(rows: int) -> pd.DataFrame:
    """Return a quadrotor that sways forward and back, tilted as that takes; one run."""
    time = np.arange(rows) / RATE
    rate, size = 2.0, 0.8
    acceleration = -size * rate**2 * np.sin(rate * time)
    pitch = np.arctan2(acceleration, _G)
    zero = np.zeros(rows)
    columns: dict[str, Any] = {"run": "run", "t": time}
    columns |= {"position_x": size * np.sin(rate * time), "position_y": zero, "position_z": zero + 2.0}
    columns |= {"velocity_x": size * rate * np.cos(rate * time), "velocity_y": zero, "velocity_z": zero}
    columns |= {"attitude_w": np.cos(pitch / 2), "attitude_x": zero, "attitude_y": np.sin(pitch / 2)}
    columns |= {"attitude_z": zero, "body_rate_x": zero, "body_rate_y": np.gradient(pitch, time)}
    columns |= {"body_rate_z": zero, "specific_force_x": zero, "specific_force_y": zero}
    columns |= {"specific_force_z": np.hypot(acceleration, _G), "battery_voltage": 16.0 - 1e-6 * time}
    command = 0.5 * np.sqrt(columns["specific_force_z"] / _G)
    turning = 0.02 * np.gradient(columns["body_rate_y"], time)
    signs = {1: 1, 2: -1, 3: -1, 4: 1}
    columns |= {f"motor_command_{rotor}": command + sign * turning for rotor, sign in signs.items()}
    return pd.DataFrame(columns)


def parquet(folder: Path, rows: int) -> Path:
    """Write a recording of the contract."""
    path = folder / "joint.parquet"
    write_recording(recording_from_frame(joint(rows), "joint"), path)
    return path


def wpilog(folder: Path, records: int) -> Path:
    """Write three numbers at each time, one a record."""
    frame = joint(records // 3)
    log = Writer()
    units = {"position": "Radian", "velocity": "Radian per Second", "voltage": "Volt"}
    state = log.start("sysid-test-state-arm", "string")
    entries = {name: log.start(f"{name}-joint-arm", "double", unit) for name, unit in units.items()}
    frame = frame.assign(voltage=10.0 * frame["effort"])
    log.text(state, 20_000_000, "quasistatic-forward")
    times = (20_000_000 + 1e6 * frame["t"]).astype(int)
    for time, *values in zip(times, *(frame[name] for name in entries), strict=True):
        for number, value in zip(entries.values(), values, strict=True):
            log.double(number, time, value)
    log.text(state, int(times.iloc[-1]), "none")
    return log.write(folder / "joint.wpilog")


def sysid(folder: Path, rows: int) -> Path:
    """Write one test."""
    frame = joint(rows)
    turns = frame[["position", "velocity"]] / (2 * np.pi)
    table = np.column_stack([frame["t"], 10.0 * frame["effort"], turns]).tolist()
    content = {
        "sysid": True,
        "test": "Simple",
        "units": "Rotations",
        "unitsPerRotation": 1.0,
        "slow-forward": table,
    }
    path = folder / "sysid.json"
    path.write_text(json.dumps(content))
    return path


def ulog_file(folder: Path, records: int) -> Path:
    """Write five topics, at each time one record of each."""
    frame = _grounded(quadrotor(records // 5))
    time = (5_000_000 + 1e6 * frame["t"]).round().astype("u8").to_numpy()
    flies = frame["flies"].to_numpy()
    signs = {"x": 1.0, "y": -1.0, "z": -1.0, "w": 1.0}

    def turned(stem: str, axes: str) -> np.ndarray:
        flip = {axis: signs[axis] if stem != "attitude" or axis in "wx" else -1.0 for axis in axes}
        return np.stack([flip[axis] * frame[f"{stem}_{axis}"] for axis in axes], 1).astype("f4")

    position, velocity = turned("position", "xyz"), turned("velocity", "xyz")
    local = dict(zip(("x", "y", "z", "vx", "vy", "vz"), (*position.T, *velocity.T), strict=True))
    motors = np.stack([frame[f"motor_command_{n}"] for n in (1, 3, 4, 2)], 1).astype("f4")
    topics = {
        "vehicle_local_position": {"timestamp": time} | local,
        "vehicle_attitude": {"timestamp": time, "q": turned("attitude", "wxyz")},
        "vehicle_angular_velocity": {"timestamp": time, "xyz": turned("body_rate", "xyz")},
        "vehicle_acceleration": {"timestamp": time, "xyz": turned("specific_force", "xyz")},
        "actuator_motors": {"timestamp": time, "control": motors},
        "vehicle_land_detected": {"timestamp": time[::100], "landed": ~flies[::100]},
    }
    path = folder / "flight.ulg"
    path.write_bytes(ulog(topics, {"SYS_AUTOSTART": 4001, "MAV_TYPE": 2}, 5_000_000))
    return path


def dataflash_file(folder: Path, records: int) -> Path:
    """Write four messages at each time, as Copter 4.5 does."""
    frame = _grounded(quadrotor(records // 4))
    flip = {"x": 1.0, "y": -1.0, "z": -1.0}
    time = (5_000_000 + 1e6 * frame["t"]).round().astype(int).to_numpy()
    first: dict[str, Any] = {"TimeUS": time, "I": np.zeros(len(time), int)}
    state = first | {f"P{k}": flip[a] * frame[f"position_{a}"] for k, a in zip("NED", "xyz", strict=True)}
    state |= {f"V{k}": flip[a] * frame[f"velocity_{a}"] for k, a in zip("NED", "xyz", strict=True)}
    turn = first | {
        f"Q{n}": (1 if a in "wx" else -1) * frame[f"attitude_{a}"] for n, a in enumerate("wxyz", 1)
    }
    felt = first | {f"Gyr{a.upper()}": flip[a] * frame[f"body_rate_{a}"] for a in "xyz"}
    felt |= {f"Acc{a.upper()}": flip[a] * frame[f"specific_force_{a}"] for a in "xyz"}
    pulses: dict[str, Any] = {"TimeUS": time} | {
        f"C{place}": 1000 + 1000 * frame[f"motor_command_{n}"] for place, n in enumerate((1, 3, 4, 2), 1)
    }
    switched = np.flatnonzero(np.diff(frame["flies"].astype(int)))
    events = {"TimeUS": [time[0], *time[switched]], "Id": [10, 28, 18]}
    messages: dict[str, tuple[str, Any]] = {
        "XKF1": ("QBffffff", state), "XKQ": ("QBffff", turn), "IMU": ("QBffffff", felt),
        "RCOU": ("QHHHH", pulses), "EV": ("QB", events),
    }  # fmt: skip
    parameters = {"FRAME_CLASS": 1, "FRAME_TYPE": 1, "MOT_PWM_MIN": 1000, "MOT_PWM_MAX": 2000}
    parameters |= {f"SERVO{n}_FUNCTION": 32 + n for n in (1, 2, 3, 4)}
    path = folder / "flight.BIN"
    path.write_bytes(dataflash(messages, parameters))
    return path


def blackbox(folder: Path, rows: int) -> Path:
    """Write one log of a flash memory."""
    path = folder / "flight.bbl"
    path.write_bytes(blackbox_of(quadrotor(rows)))
    return path


def _states(store: object, rows: int) -> Iterator[tuple[str, str, float, object]]:
    frame = joint(rows)
    for t, *state in frame[["t", "position", "velocity", "effort"]].to_numpy().tolist():
        message = bag_writer.joint_state(store, t, {"elbow": tuple(state)})
        yield "/joint_states", "sensor_msgs/msg/JointState", t, message


def bag1(folder: Path, rows: int) -> Path:
    """Write the state of a joint."""
    return bag_writer.write_ros1(folder / "joint.bag", _states(bag_writer.ROS1, rows))


def bag2(folder: Path, rows: int) -> Path:
    """Write the state of a joint into a database."""
    return bag_writer.write_ros2(folder / "bag", _states(bag_writer.ROS2, rows))


def mcap(folder: Path, rows: int) -> Path:
    """Write the state of a joint as ROS 2 does."""
    return bag_writer.write_ros2(folder / "mcap", _states(bag_writer.ROS2, rows), mcap=True)


def mcap_json(folder: Path, rows: int) -> Path:
    """Write the state of a joint as text."""
    frame = joint(rows)
    entries = frame[["t", "position", "velocity", "effort"]].to_dict("records")
    messages = (
        (
            "/joint_states",
            e["t"],
            {"name": ["elbow"]} | {k: [e[k]] for k in ("position", "velocity", "effort")},
        )
        for e in entries
    )
    return bag_writer.write_json(folder / "json.mcap", messages)


def lerobot(folder: Path, rows: int) -> Path:
    """Write one episode of one joint."""
    frame = joint(rows)
    root = folder / "set"
    (root / "meta").mkdir(parents=True)
    (root / "data/chunk-000").mkdir(parents=True)
    names = ["elbow.pos"]
    features = {key: {"dtype": "float32", "names": names} for key in ("action", "observation.state")}
    info = {"codebase_version": "v3.0", "robot_type": "so101", "fps": RATE, "features": features}
    (root / "meta/info.json").write_text(json.dumps(info))
    state = np.degrees(2.0 * frame["position"].to_numpy()).astype("f4")
    kind = pa.list_(pa.float32(), 1)
    columns = {
        "action": pa.FixedSizeListArray.from_arrays(np.roll(state, -5), 1).cast(kind),
        "observation.state": pa.FixedSizeListArray.from_arrays(state, 1).cast(kind),
        "timestamp": frame["t"].to_numpy(dtype="f4"),
        "frame_index": np.arange(rows),
        "episode_index": np.zeros(rows, dtype=int),
    }
    pq.write_table(pa.table(columns), root / "data/chunk-000/file-000.parquet")
    return root


def crazyflie(folder: Path, events: int) -> Path:
    """Write two types of events: motors and sensors, and the estimate, one of each at each time."""
    frame = quadrotor(events // 2)
    fast = {f"gyro.{a}": ("f4", np.rad2deg(frame[f"body_rate_{a}"])) for a in "xyz"}
    fast |= {f"acc.{a}": ("f4", frame[f"specific_force_{a}"] / _G) for a in "xyz"}
    fast |= {f"motor.m{n}": ("u2", 65535 * frame[f"motor_command_{n}"]) for n in (1, 2, 3, 4)}
    slow = {f"stateEstimate.{a}": ("f4", frame[f"position_{a}"]) for a in "xyz"}
    slow |= {f"stateEstimate.v{a}": ("f4", frame[f"velocity_{a}"]) for a in "xyz"}
    slow |= {f"stateEstimate.q{a}": ("f4", frame[f"attitude_{a}"]) for a in "wxyz"}
    parts, body = [], struct.pack("<BHH", 0xBC, 2, 2)
    for number, (name, variables) in enumerate({"fixedFrequency": fast, "estimate": slow}.items()):
        body += struct.pack("<H", number) + name.encode() + b"\0" + struct.pack("<H", len(variables))
        letters = {"f4": "f", "u2": "H"}
        body += b"".join(f"{key}({letters[kind]})".encode() + b"\0" for key, (kind, _) in variables.items())
        layout = [
            ("number", "<u2"),
            ("time", "<u8"),
            *((key, f"<{kind}") for key, (kind, _) in variables.items()),
        ]
        rows = np.zeros(len(frame), dtype=layout)
        rows["number"], rows["time"] = number, (5_000_000 + 1e6 * frame["t"] + 500 * number).round()
        for key, (_, values) in variables.items():
            rows[key] = values
        parts.append(rows.view(np.uint8).reshape(len(rows), -1))
    body += np.concatenate(parts, axis=1).tobytes()
    path = folder / "log00.bin"
    path.write_bytes(body + struct.pack("<I", zlib.crc32(body)))
    return path


def _grounded(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a flight that begins and ends on the ground, two metres below; it says so half a second late."""
    place = np.arange(len(frame))
    inside = np.minimum(place, place[::-1])
    low = np.where(inside < _ON_GROUND, 0.0, frame["position_z"])
    return frame.assign(flies=inside > _ON_GROUND - 0.5 * RATE, position_z=low)


MAKERS: Mapping[str, Callable[[Path, int], Path]] = {
    "Parquet": parquet,
    "WPILOG": wpilog,
    "SysId JSON": sysid,
    "PX4 ULog": ulog_file,
    "ArduPilot DataFlash": dataflash_file,
    "Blackbox": blackbox,
    "ROS 1 bag": bag1,
    "ROS 2 bag": bag2,
    "MCAP": mcap,
    "MCAP, JSON": mcap_json,
    "LeRobot": lerobot,
    "Crazyflie": crazyflie,
}
"""By format: what writes a log with so many records into a folder."""
