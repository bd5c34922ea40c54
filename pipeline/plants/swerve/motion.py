"""Closed-loop simulation of a swerve drive at 1 kHz, all runs at once."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.delay import Commands
from simgap.plants.joint import effects as joint
from simgap.plants.joint.friction import Friction, friction_of
from simgap.plants.joint.supply import Battery
from simgap.plants.rotation import Array
from simgap.plants.swerve.case import SwerveCase
from simgap.plants.swerve.chassis import Chassis, chassis_of
from simgap.plants.swerve.controller import ModuleController
from simgap.plants.swerve.motors import Motors, motors_of, shared_battery
from simgap.plants.swerve.reference import Reference
from simgap.plants.swerve.steering import Scrub, scrub_of, steering_of
from simgap.platforms import Swerve

STEP = 1e-3  # s
SETTLING = 0.8  # s that pass before the recording starts
_WHEEL_BRISTLES = 100.0  # rad/s at which the robot swings on the bristles of its wheels' friction


@dataclass(frozen=True)
class Log:
    """True signals at every step from `-SETTLING` on; (steps, runs, 4) but for the last two.

    Attributes:
        drive_voltage: commanded, V.
        steer_voltage: commanded, V.
        drive_velocity: of the motors, rad/s.
        steer_velocity: of the modules, rad/s.
        steer_angle: as the encoders' zeros have it, rad.
        drive_current: A.
        steer_current: A.
        twist: of the chassis, robot frame, (steps, runs, 3).
        battery_voltage: (steps, runs) V.
    """

    drive_voltage: Array
    steer_voltage: Array
    drive_velocity: Array
    steer_velocity: Array
    steer_angle: Array
    drive_current: Array
    steer_current: Array
    twist: Array
    battery_voltage: Array


class Robot:
    """Everything that has a state."""

    def __init__(
        self,
        effects: Concealed,
        outside: Concealed,
        platform: Swerve,
        case: SwerveCase,
        reference: Reference,
        random: np.random.Generator,
    ) -> None:
        """Put the robot at rest at the first step of its references."""
        size, runs = case.size(platform), case.runs
        self.shape = (runs, 4)
        self.coupling = effects.get("drive_steer_coupling@drive", "ratio")
        self.chassis: Chassis = chassis_of(effects, outside, platform, runs)
        self.drive: Motors = motors_of(effects, "drive", platform.drive, runs)
        self.steer: Motors = motors_of(effects, "steer", platform.steer, runs)
        start = reference.angle[0].ravel(), np.zeros(4 * runs)
        self.modules = steering_of(effects, outside, platform, size["module_torque"], start)
        self.scrub: Scrub | None = scrub_of(effects, platform, size["module_torque"], 4 * runs)
        self.friction = _wheel_friction(effects, platform, size["wheel_torque"])
        self.bristles = np.zeros(self.shape)
        typical = 4.0 * (size["drive_current"] + size["steer_current"])
        self.battery: Battery = shared_battery(effects, self.drive, typical, runs, random)
        self.voltage = self.battery.source

    def angle(self) -> Array:
        """Return the modules' angles, (runs, 4) rad."""
        return self.modules.position[-1].reshape(self.shape)

    def rate(self) -> Array:
        """Return the modules' rates, (runs, 4) rad/s."""
        return self.modules.velocity[-1].reshape(self.shape)

    def motor_speed(self) -> Array:
        """Return the drive motors' speeds, (runs, 4) rad/s."""
        wheels = self.chassis.rolling / self.chassis.radius
        return self.drive.gear_ratio * wheels + self.coupling * self.rate()

    def wheel_torque(self, command: Array) -> Array:
        """Return what turns the wheels (runs, 4), N·m, and let currents and bristles follow for a step."""
        torque = self.drive.torque(command, self.motor_speed(), self.voltage, STEP)
        speed = self.chassis.rolling / self.chassis.radius
        if self.friction.speed_dependent:
            torque = torque + self.friction.speed_force(speed)
        if self.friction.dry:
            still = np.zeros(self.shape)
            level = self.friction.level(speed, still, still, still)
            self.bristles = self.friction.bend(self.bristles, speed, level, STEP)
            torque = torque + self.friction.dry_force(self.bristles, speed, level)
        return torque

    def turn(self, command: Array) -> None:
        """Complete a step of the modules with the steering voltages (runs, 4), V, at its end."""
        modules, ratio = self.modules, self.steer.gear_ratio
        foreseen = modules.foreseen
        speed = ratio * foreseen[0].reshape(self.shape)
        torque = self.steer.torque(command, speed, self.voltage, STEP)
        external = self.coupling * self.drive.torque_constant * self.drive.current
        modules.external = external.ravel()
        if self.scrub:
            rolling = self.chassis.rolling.ravel()
            modules.external = modules.external + self.scrub.torque(foreseen[-1], rolling, STEP)
        modules.push(torque.ravel(), STEP)


def move(
    effects: Concealed,
    outside: Concealed,
    platform: Swerve,
    case: SwerveCase,
    reference: Reference,
    random: np.random.Generator,
    controller: ModuleController | None = None,
) -> Log:
    """Drive all references in closed loop and log the truth.

    Args:
        effects: what the catalogue names.
        outside: what it does not.
        platform: what the controllers believe.
        case: how it is driven.
        reference: of all modules.
        random: the battery's charge and the encoders' noise.
        controller: of the modules; the one that follows the references unless given.
    """
    robot = Robot(effects, outside, platform, case, reference, random)
    controller = controller or ModuleController(platform, case, reference)
    shape = reference.angle.shape
    noise = case.sensors.scale * case.sensors.steer_angle * random.standard_normal(shape)
    drive = Commands(effects.get("command_delay@drive", "delay"), STEP, shape)
    steer = Commands(effects.get("command_delay@steer", "delay"), STEP, shape)
    every = round(1.0 / (case.rate * STEP)) if case.held else 1
    rows: list[tuple[Array, ...]] = []
    for count in range(shape[0]):
        if count % every == 0:
            drive.note(count, controller.drive(count, robot.motor_speed()))
        else:
            drive.keep(count)
        torque = robot.wheel_torque(drive.at(count))
        truth = robot.motor_speed(), robot.rate(), robot.angle(), robot.drive.current
        rows.append((*truth, robot.steer.current, robot.chassis.twist, robot.voltage))
        robot.modules.travel(STEP)
        robot.chassis.advance(robot.angle(), torque, STEP)
        ahead = min(count + 1, shape[0] - 1)
        if ahead % every == 0:
            foreseen = robot.modules.foreseen[-1].reshape(robot.shape)
            steer.note(ahead, controller.steer(ahead, robot.angle() + noise[ahead], foreseen))
        else:
            steer.keep(ahead)
        drawn = robot.drive.drawn(drive.at(count)) + robot.steer.drawn(steer.at(ahead))
        robot.voltage = robot.battery.voltage(drawn, STEP)
        robot.turn(steer.at(ahead))
    columns = [np.stack(column) for column in zip(*rows, strict=True)]
    return Log(drive.series, steer.series, *columns)


def _wheel_friction(effects: Concealed, platform: Swerve, effort: float) -> Friction:
    """Return the friction about each wheel's axle."""
    own = effects.group("drive").values
    known = Concealed(
        {name: values for name, values in own.items() if name in joint.CONCEALABLE}, joint.CONCEALABLE, {}
    )
    inertia = 0.25 * platform.mass * platform.wheel_radius**2
    return friction_of(known, Concealed({}, joint.OUTSIDE, {}), inertia, effort, _WHEEL_BRISTLES)
