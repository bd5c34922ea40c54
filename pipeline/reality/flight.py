"""The closed loop, a thousand steps a second, all runs at once."""

from dataclasses import dataclass

import numpy as np

from pipeline.platforms import Quadrotor
from pipeline.reality.airframe import Airframe
from pipeline.reality.case import PlantCase
from pipeline.reality.controller import Controller
from pipeline.reality.dither import Dither
from pipeline.reality.path import Paths
from pipeline.reality.rotation import Array, cross, matrix, product

STEP = 1e-3  # s
SETTLING = 1.5  # s flown before the recording starts
_GYRO_CUT_OFF = 250.0  # rad/s, of the low-pass between gyro and rate controller
_LAG_SPREAD = 0.1  # standard deviation of the rotors' time constants over their mean


@dataclass(frozen=True)
class Log:
    """What truly happened, every `step` from `-SETTLING` on; (steps, runs, ...) each.

    Attributes:
        position: m.
        velocity: world frame, m/s.
        attitude: body to world.
        body_rate: rad/s.
        specific_force: body frame, m/s².
        rotor_speed: rad/s.
        rotor_command: rad/s.
        step: s.
    """

    position: Array
    velocity: Array
    attitude: Array
    body_rate: Array
    specific_force: Array
    rotor_speed: Array
    rotor_command: Array
    step: float = STEP


def fly_paths(
    airframe: Airframe,
    platform: Quadrotor,
    case: PlantCase,
    paths: Paths,
    dither: Dither,
    random: np.random.Generator,
    step: float = STEP,
) -> Log:
    """Fly all paths in closed loop and log the truth.

    The state advances by the two-step rule of Adams and Bashforth, of second order: one evaluation per step,
    and no shift in time between force and motion that would look like a sensor's delay.

    Args:
        airframe: the plant.
        platform: what the controller believes.
        case: motor lag and gyro noise are taken from it.
        paths: where to go.
        dither: what is shaken on the way.
        random: for the gyro noise in the loop and the spread of the rotors.
        step: s.
    """
    count = round((SETTLING + case.duration) / step) + 1
    times = np.arange(count, dtype=np.float64) * step - SETTLING
    decay, estimate = _lag_decay(case, random, step), _Gyro(case, random, step)
    controller = Controller(platform)
    state, before = _start(paths, times[0]), None
    speed = np.full((len(paths.names), 4), platform.hover_rotor_speed)
    inflow = airframe.rotor.still_inflow(speed)
    kept: list[tuple[Array, Array, Array, Array]] = []
    for *reference, shaking in zip(*paths.at(times), dither.at(times), strict=True):
        rotation, body_rate = matrix(state[:, 6:10]), state[:, 10:]
        pose = state[:, :3], state[:, 3:6], rotation, estimate(body_rate)
        command = controller.command(reference, *pose, shaking)
        speed = command + (speed - command) * decay
        velocity = (state[:, None, 3:6] @ rotation)[:, 0]
        force, torque, inflow = airframe.wrench(velocity, body_rate, speed, inflow)
        kept.append((state, force, speed, command))
        rate = _derivative(airframe, state, rotation, force, torque)
        state = state + step * (rate if before is None else 1.5 * rate - 0.5 * before)
        state[:, 6:10] /= np.sqrt((state[:, 6:10] ** 2).sum(axis=-1, keepdims=True))
        before = rate
    states, forces, speeds, commands = (np.stack(part) for part in zip(*kept, strict=True))
    motion = states[..., :3], states[..., 3:6], states[..., 6:10], states[..., 10:]
    return Log(*motion, forces, speeds, commands, step)


class _Gyro:
    """The autopilot's own gyro: noisy, then low-passed."""

    def __init__(self, case: PlantCase, random: np.random.Generator, step: float) -> None:
        self.noise = case.sensors.scale * case.sensors.body_rate
        self.share = 1.0 - np.exp(-step * _GYRO_CUT_OFF)
        self.random = random
        self.value: Array | None = None

    def __call__(self, body_rate: Array) -> Array:
        reading = body_rate + self.noise * self.random.standard_normal(body_rate.shape)
        self.value = reading if self.value is None else self.value + self.share * (reading - self.value)
        return self.value


def _start(paths: Paths, time: float) -> Array:
    """On the path at its speed, level, the nose along the heading: (runs, 13)."""
    place, speed, _ = paths.at(time)
    half = 0.5 * place[:, 3]
    state = np.zeros((len(half), 13))
    state[:, :3], state[:, 3:6] = place[:, :3], speed[:, :3]
    state[:, 6], state[:, 9] = np.cos(half), np.sin(half)
    return state


def _lag_decay(case: PlantCase, random: np.random.Generator, step: float) -> Array:
    """Share of the distance to the command that each rotor keeps over a step, (4,)."""
    spread = 1.0 + _LAG_SPREAD * np.clip(random.standard_normal(4), -2.0, 2.0)
    mean = case.strength("motor_lag")
    return np.exp(-step / (mean * spread)) if mean > 0 else np.zeros(4)


def _derivative(airframe: Airframe, state: Array, rotation: Array, force: Array, torque: Array) -> Array:
    body_rate = state[:, 10:]
    acceleration = (rotation @ force[..., None])[..., 0]
    acceleration[:, 2] -= airframe.gravity
    spin = np.concatenate((np.zeros_like(body_rate[:, :1]), body_rate), axis=-1)
    turning = 0.5 * product(state[:, 6:10], spin)
    angular = (torque - cross(body_rate, airframe.inertia * body_rate)) / airframe.inertia
    return np.concatenate((state[:, 3:6], acceleration, turning, angular), axis=-1)
