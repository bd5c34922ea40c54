"""Drive of a joint: delay, dead zone, supply, winding, inductance and current limit."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.supply import AMBIENT, COPPER_SHARE, Battery, Winding, battery_of, winding_of
from simgap.plants.rotation import Array
from simgap.platforms import Joint


@dataclass
class Drive:
    """The drive of one axis.

    Attributes:
        resistance: at ambient temperature, Ω; 0 where an effort is commanded.
        constant: effort per current, N·m/A, and back-EMF per velocity, V·s/rad; 1 where an effort is commanded.
        supply: nominal voltage, V.
        sagging: whether the battery's voltage reaches the motor.
        weakening: by warmth, at standstill, 1/K.
        dead_zone: half width, in the unit of the command.
        electrical: time constant of the winding, s.
        limit: of the current, A.
        battery: its state.
        winding: its state.
        current: (runs,) A.
        voltage: of the battery, (runs,) V.
        cold: effort that the motor would give at ambient temperature, (runs,) N·m or N.
    """

    resistance: float
    constant: float
    supply: float
    sagging: bool
    weakening: float
    dead_zone: float
    electrical: float
    limit: float
    battery: Battery
    winding: Winding
    current: Array
    voltage: Array
    cold: Array

    def effort(self, command: Array, velocity: Array, step: float) -> Array:
        """Return the motor's effort at the joint (runs,), N·m or N.

        Args:
            command: delayed, V or N·m or N.
            velocity: of the motor in the joint's terms, rad/s or m/s.
            step: since the last call, s; 0 to look without letting time pass.
        """
        if self.dead_zone:
            command = command - np.clip(command, -self.dead_zone, self.dead_zone)
        lost = self.weakening * (self.winding.temperature - AMBIENT)
        if not self.resistance:
            self.current = self.cold = command
            self.winding.warm(command, step)
            return (1.0 - lost) * command
        drawn = np.abs(command / self.supply * self.current)
        self.voltage = self.battery.voltage(drawn, step)
        applied = command * (self.voltage / self.supply) if self.sagging else command
        resistance = self.resistance * (1.0 + COPPER_SHARE * lost)
        self.cold = self.constant * (applied - self.constant * velocity) / self.resistance
        constant = self.constant * (1.0 - (1.0 - COPPER_SHARE) * lost)
        settled = (applied - constant * velocity) / resistance
        if self.electrical:
            settled = settled + (self.current - settled) * np.exp(-step / self.electrical)
        self.current = np.clip(settled, -self.limit, self.limit)
        self.winding.warm(self.current, step)
        return constant * self.current


def drive_of(effects: Concealed, platform: Joint, case: JointCase, random: np.random.Generator) -> Drive:
    """Return the drive that a case conceals, before its first step."""
    motor, size = platform.motor, case.size(platform)
    ratio = effects.get("motor_constant_error", "ratio")
    still = np.zeros(case.runs)
    return Drive(
        resistance=motor.resistance if motor else 0.0,
        constant=motor.torque_constant * motor.gear_ratio * ratio if motor else 1.0,
        supply=case.supply,
        sagging="battery_sag" in effects,
        weakening=effects.get("temperature_derating", "coefficient"),
        dead_zone=effects.get("dead_zone", "width"),
        electrical=effects.get("motor_inductance", "time_constant"),
        limit=effects.get("current_limit", "limit"),
        battery=battery_of(effects, case.supply, size["current"], case.runs, random),
        winding=winding_of(size["current"], case.runs, random),
        current=still,
        voltage=np.full(case.runs, case.supply),
        cold=still,
    )
