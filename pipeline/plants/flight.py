"""Closed-loop simulation of flights at 1 kHz, all runs at once."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.airframe import Airframe
from simgap.plants.battery import Battery
from simgap.plants.case import PlantCase
from simgap.plants.controller import Controller, tuned
from simgap.plants.dither import Dither
from simgap.plants.drive import Drive
from simgap.plants.integration import AdamsBashforth
from simgap.plants.path import Paths
from simgap.plants.plant import build
from simgap.plants.rotation import Array, cross, matrix, product
from simgap.platforms import Quadrotor

STEP = 1e-3  # s
SETTLING = 1.5  # s flown before the recording starts
_GYRO_CUT_OFF = 250.0  # rad/s, of the low-pass between gyro and rate controller


@dataclass(frozen=True)
class Log:
    """What truly happened, every `step` from `-before` on; (steps, runs, ...) each.

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
        before: what is logged before the recording starts, s.
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
    before: float = SETTLING


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
    machines = Machines(airframe, platform, case, battery, random, count, step)
    controller = Controller(platform, tuned(case, platform), step)
    machines.state = _start(paths, times[0])
    kept: list[tuple[Array, ...]] = []
    for *reference, shaking in zip(*paths.at(times), dither.at(times), strict=True):
        state = machines.state
        pose = state[:, :3], state[:, 3:6], matrix(state[:, 6:10]), machines.felt_rate()
        kept.append(machines.advance(controller.command(reference, *pose, shaking)))
    return log_of(kept, step, machines.plant.wind)


class Machines:
    """The machines of all runs with their air, motors, batteries and gyros, of which a command moves them a step.

    Attributes:
        plant: what pushes and turns them.
        state: position, velocity (world), attitude and body rate, (runs, 13).
    """

    def __init__(
        self,
        airframe: Airframe,
        platform: Quadrotor,
        case: PlantCase,
        battery: Battery,
        random: np.random.Generator,
        steps: int,
        step: float = STEP,
    ) -> None:
        """Build them; see `fly_paths`. They fly for at most so many steps."""
        self.plant = build(airframe, platform, case, steps, step, random)
        self.state = np.zeros((case.runs, 13))
        self._drive, self._gyro = Drive(platform, case, random, step, battery), Gyro(case, random, step)
        self._integrate = AdamsBashforth(step)
        self._airframe, self._index = airframe, 0

    def felt_rate(self) -> Array:
        """Return what the gyros tell of the body rates (runs, 3), rad/s; to be asked once a step."""
        return self._gyro(self.state[:, 10:])

    def advance(self, command: Array) -> tuple[Array, ...]:
        """Move on by a step under commanded rotor speeds (runs, 4), rad/s.

        Returns:
            The state before, specific force, rotor speed, the command, and the voltage where motors feel it.
        """
        state, rotation = self.state, matrix(self.state[:, 6:10])
        speed, acceleration = self._drive(command)
        force, torque = self.plant.push(self._index, state, rotation, speed, acceleration)
        rate = _derivative(self._airframe, state, rotation, force, torque)
        self.state = self._integrate(state, rate)
        self.state[:, 6:10] /= np.sqrt((self.state[:, 6:10] ** 2).sum(axis=-1, keepdims=True))
        self._index += 1
        voltage = self._drive.voltage
        return (state, force, speed, command, *([] if voltage is None else [voltage]))


def log_of(
    kept: list[tuple[Array, ...]], step: float, wind: Array | None = None, before: float = SETTLING
) -> Log:
    """Return the log of what was kept at every step: state, force, speed, command, and voltage where it is felt."""
    states, forces, speeds, commands, *voltage = (np.stack(part) for part in zip(*kept, strict=True))
    motion = states[..., :3], states[..., 3:6], states[..., 6:10], states[..., 10:]
    return Log(*motion, forces, speeds, commands, step, wind, voltage[0] if voltage else None, before)


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
