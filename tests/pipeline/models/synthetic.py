"""Machines whose parameters are known, and recordings of them."""

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from simgap.platforms import Quadrotor
from simgap.recordings.contract import channel_units
from simgap.recordings.recording import Recording

MOTOR = {"kS": 0.25, "kV": 2.4, "kA": 0.35}

QUADROTOR = Quadrotor(
    mass=0.8,
    inertia=(2.5e-3, 2.1e-3, 4.3e-3),
    rotor_positions=((0.08, -0.1, 0.0), (-0.08, -0.1, 0.0), (-0.08, 0.1, 0.0), (0.08, 0.1, 0.0)),
    rotor_directions=(-1, 1, -1, 1),
    thrust_coefficient=1.5e-6,
    torque_coefficient=3.0e-8,
    motor_speed_max=2300.0,
    nominal_voltage=14.8,
)


def recording(
    frame: pd.DataFrame, kind: str, split: dict[str, str] | None = None, sliding: bool = False
) -> Recording:
    """Return a cleaned recording of a frame."""
    known = channel_units(kind, sliding)
    units = {column: known[column] for column in frame.columns if column in known}
    return Recording(frame, kind, units, split=split or {}, cleaned=True)


def motor_run(
    voltage: np.ndarray, time_step: float, seed: int, noise: float = 0.0, disturbance: float = 0.0
) -> np.ndarray:
    """Return the speed of a motor from rest, solved exactly over each sample.

    Args:
        voltage: held from each sample to the next, V.
        time_step: s.
        seed: of the noise.
        noise: standard deviation of the measured speed.
        disturbance: standard deviation of a voltage that comes and goes within 0.1 s, V.
    """
    rng = np.random.default_rng(seed)
    decay = np.exp(-MOTOR["kV"] / MOTOR["kA"] * time_step)
    memory = np.exp(-time_step / 0.1)
    speed, push = np.zeros(len(voltage)), 0.0
    for k in range(len(voltage) - 1):
        push = memory * push + np.sqrt(1 - memory**2) * disturbance * rng.normal()
        effective = voltage[k] + push
        direction = np.sign(speed[k]) or np.sign(effective)
        if speed[k] == 0.0 and abs(effective) < MOTOR["kS"]:
            continue
        speed[k + 1] = decay * speed[k] + (1 - decay) / MOTOR["kV"] * (effective - MOTOR["kS"] * direction)
        if speed[k + 1] * direction < 0.0:
            speed[k + 1] = 0.0
    return speed + noise * rng.normal(size=len(speed))


def motor_frame(run: str, voltage: np.ndarray, time_step: float, seed: int, **options: float) -> pd.DataFrame:
    """Return one run of a sliding joint."""
    speed = motor_run(voltage, time_step, seed, **options)
    position = np.cumsum(speed) * time_step
    time = np.arange(len(voltage)) * time_step
    return pd.DataFrame(
        {"run": run, "t": time, "segment": 0, "position": position, "velocity": speed, "voltage": voltage}
    )


def characterisation(seed: int, time_step: float = 0.005, **options: float) -> Recording:
    """Return slow ramps and steps in both directions, as WPILib SysId drives them."""
    slow = 0.5 * np.arange(0.0, 12.0, time_step)
    steps = np.repeat([0.0, 7.0, 3.0, 6.0], round(1.0 / time_step))
    frames = [
        motor_frame(f"{name}-{way}", sign * voltage, time_step, 4 * seed + number, **options)
        for number, (name, voltage, way, sign) in enumerate(
            (
                ("slow", slow, "f", 1),
                ("slow", slow, "b", -1),
                ("fast", steps, "f", 1),
                ("fast", steps, "b", -1),
            )
        )
    ]
    return recording(pd.concat(frames, ignore_index=True), "joint", sliding=True)


def flight(
    run: str, seed: int, duration: float = 8.0, time_step: float = 0.01, substeps: int = 2
) -> pd.DataFrame:
    """Return a flight without noise: smooth body rates and thrust, and the rotor speeds that they need."""
    rng = np.random.default_rng(seed)
    step = time_step / substeps
    time = np.arange(0.0, duration, step)
    rate, change = _wander(rng, time, 3, amplitude=0.5)
    lift, _ = _wander(rng, time, 1, amplitude=0.05)
    thrust = QUADROTOR.mass * QUADROTOR.gravity * (1.0 + lift[:, 0])
    inertia = np.array(QUADROTOR.inertia)
    torque = inertia * change + np.cross(rate, inertia * rate)
    attitude, velocity = _integrate(rate, thrust, step)
    speeds = np.sqrt(np.column_stack([thrust, torque]) @ np.linalg.inv(_allocation()).T)
    position = np.cumsum(velocity, axis=0) * step
    columns = {"position": position, "velocity": velocity, "body_rate": rate}
    data = {
        f"{name}_{axis}": values[:, i] for name, values in columns.items() for i, axis in enumerate("xyz")
    }
    data |= {f"attitude_{axis}": attitude[:, i] for i, axis in enumerate("wxyz")}
    data |= {f"motor_speed_{number + 1}": speeds[:, number] for number in range(4)}
    frame = pd.DataFrame({"run": run, "t": time, "segment": 0} | data)
    return frame.iloc[::substeps].reset_index(drop=True)


def with_noise(frame: pd.DataFrame, seed: int) -> pd.DataFrame:
    """Return a flight as sensors see it."""
    rng = np.random.default_rng(seed)
    levels = {"velocity": 0.02, "body_rate": 0.02, "motor_speed": 2.0}
    noisy = frame.copy()
    for stem, level in levels.items():
        for column in [name for name in frame if name.startswith(stem)]:
            noisy[column] = frame[column] + level * rng.normal(size=len(frame))
    return noisy


def _wander(
    rng: np.random.Generator, time: np.ndarray, channels: int, amplitude: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return sums of six sines up to 2.5 Hz (samples, channels) and their exact derivatives."""
    frequency = 2 * np.pi * rng.uniform(0.3, 2.5, (6, channels))
    phase = rng.uniform(0, 2 * np.pi, (6, channels))
    angle = frequency * time[:, None, None] + phase
    return amplitude * np.sin(angle).sum(1), amplitude * (frequency * np.cos(angle)).sum(1)


def _integrate(rate: np.ndarray, thrust: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    middle = 0.5 * (rate[1:] + rate[:-1])
    turns = Rotation.from_rotvec(middle * step)
    attitude = [Rotation.identity()]
    for turn in turns:
        attitude.append(attitude[-1] * turn)
    body_to_world = Rotation.concatenate(attitude)
    force = np.zeros((len(rate), 3))
    force[:, 2] = thrust / QUADROTOR.mass
    acceleration = body_to_world.apply(force) - [0.0, 0.0, QUADROTOR.gravity]
    increments = 0.5 * step * (acceleration[1:] + acceleration[:-1])
    velocity = np.concatenate([np.zeros((1, 3)), np.cumsum(increments, axis=0)])
    return body_to_world.as_quat(scalar_first=True), velocity


def _allocation() -> np.ndarray:
    """Return the map (4, 4) from squared rotor speeds to thrust and torques."""
    positions = np.array(QUADROTOR.rotor_positions)
    force = QUADROTOR.thrust_coefficient
    return np.stack(
        [
            np.full(4, force),
            force * positions[:, 1],
            -force * positions[:, 0],
            QUADROTOR.torque_coefficient * np.array(QUADROTOR.rotor_directions),
        ]
    )
