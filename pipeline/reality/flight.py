"""The closed loop, a thousand steps a second, all runs at once."""

from dataclasses import dataclass

import numpy as np

from pipeline.platforms import Quadrotor
from pipeline.reality.airframe import Airframe
from pipeline.reality.battery import Battery
from pipeline.reality.case import PlantCase
from pipeline.reality.controller import Controller, tuned
from pipeline.reality.dither import Dither
from pipeline.reality.drive import Drive
from pipeline.reality.integration import AdamsBashforth
from pipeline.reality.path import Paths
from pipeline.reality.plant import build
from pipeline.reality.rotation import Array, cross, matrix, product

STEP = 1e-3  # s
SETTLING = 1.5  # s flown before the recording starts
_GYRO_CUT_OFF = 250.0  # rad/s, of the low-pass between gyro and rate controller


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
        wind: world frame, m/s; None in still air.
        voltage: of the battery (steps, runs), V; None where the motors do not feel it.
    """

    position: Array
    velocity: Array
    attitude: Array
    body_rate: Array
    specific_force: Array
    rotor_speed: Array
    rotor_command: Array
    step: float = STEP
    wind: Array | None = None
    voltage: Array | None = None


def fly_paths(
    airframe: Airframe,
    platform: Quadrotor,
    case: PlantCase,
    paths: Paths,
    dither: Dither,
    battery: Battery,
    random: np.random.Generator,
    step: float = STEP,
) -> Log:
    """Fly all paths in closed loop and log the truth.

    Args:
        airframe: the plant.
        platform: what the controller believes.
        case: what is concealed, and the gyro noise.
        paths: where to go.
        dither: what is shaken on the way.
        battery: of all runs, full or not.
        random: for the gyro noise in the loop, the spread of the rotors, gusts and flutter.
        step: s.
    """
    count = round((SETTLING + case.duration) / step) + 1
    times = np.arange(count, dtype=np.float64) * step - SETTLING
    plant = build(airframe, platform, case, count, step, random)
    drive, estimate = Drive(platform, case, random, step, battery), Gyro(case, random, step)
    controller, advance = Controller(platform, tuned(case, platform), step), AdamsBashforth(step)
    state = _start(paths, times[0])
    kept: list[tuple[Array, ...]] = []
    for index, (*reference, shaking) in enumerate(zip(*paths.at(times), dither.at(times), strict=True)):
        rotation, body_rate = matrix(state[:, 6:10]), state[:, 10:]
        pose = state[:, :3], state[:, 3:6], rotation, estimate(body_rate)
        command = controller.command(reference, *pose, shaking)
        speed, acceleration = drive(command)
        force, torque = plant.push(index, state, rotation, speed, acceleration)
        kept.append((state, force, speed, command, *([] if drive.voltage is None else [drive.voltage])))
        state = advance(state, _derivative(airframe, state, rotation, force, torque))
        state[:, 6:10] /= np.sqrt((state[:, 6:10] ** 2).sum(axis=-1, keepdims=True))
    return log_of(kept, step, plant.wind)


def log_of(kept: list[tuple[Array, ...]], step: float, wind: Array | None = None) -> Log:
    """Return the log of what was kept at every step: state, force, speed, command, and voltage where it is felt."""
    states, forces, speeds, commands, *voltage = (np.stack(part) for part in zip(*kept, strict=True))
    motion = states[..., :3], states[..., 3:6], states[..., 6:10], states[..., 10:]
    return Log(*motion, forces, speeds, commands, step, wind, voltage[0] if voltage else None)


class Gyro:
    """The autopilot's own gyro: noisy, then low-passed."""

    def __init__(self, case: PlantCase, random: np.random.Generator, step: float) -> None:
        self.noise = case.sensors.scale * case.sensors.body_rate
        self.share = 1.0 - np.exp(-step * _GYRO_CUT_OFF)
        self.random = random
        self.value: Array | None = None

    def __call__(self, body_rate: Array) -> Array:
        """Return what the rate controller is told of body rates (runs, 3), rad/s."""
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


def _derivative(airframe: Airframe, state: Array, rotation: Array, force: Array, torque: Array) -> Array:
    body_rate = state[:, 10:]
    acceleration = (rotation @ force[..., None])[..., 0]
    acceleration[:, 2] -= airframe.gravity
    spin = np.concatenate((np.zeros_like(body_rate[:, :1]), body_rate), axis=-1)
    turning = 0.5 * product(state[:, 6:10], spin)
    angular = (torque - cross(body_rate, airframe.inertia * body_rate)) / airframe.inertia
    return np.concatenate((state[:, 3:6], acceleration, turning, angular), axis=-1)
