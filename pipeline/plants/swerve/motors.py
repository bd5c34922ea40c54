"""Four motors of one group with their controllers, and the shared battery of all eight motors."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.joint.supply import Battery, battery_of
from simgap.plants.rotation import Array
from simgap.platforms.swerve import SwerveAxis


@dataclass
class Motors:
    """The drive or the steering motors of all modules; currents and voltages are (runs, 4).

    Attributes:
        gear_ratio: motor turns per turn of wheel or module.
        resistance: Ω.
        torque_constant: N·m/A.
        back_emf_constant: V/(rad/s).
        nominal_voltage: V, of the battery at which a command is what it says.
        sagging: whether the controllers pass the battery's voltage on.
        electrical: time constant of the windings, s.
        limit: of the current, A.
        current: A.
    """

    gear_ratio: float
    resistance: float
    torque_constant: float
    back_emf_constant: float
    nominal_voltage: float
    sagging: bool
    electrical: float
    limit: float
    current: Array

    def torque(self, command: Array, speed: Array, battery: Array, step: float) -> Array:
        """Return the motors' torque behind the gears, (runs, 4) N·m.

        Args:
            command: V.
            speed: of the motors, rad/s.
            battery: its voltage, (runs,) V.
            step: since the last call, s.
        """
        applied = command * (battery / self.nominal_voltage)[:, None] if self.sagging else command
        settled = (applied - self.back_emf_constant * speed) / self.resistance
        if self.electrical:
            settled = settled + (self.current - settled) * np.exp(-step / self.electrical)
        self.current = np.clip(settled, -self.limit, self.limit)
        return self.gear_ratio * self.torque_constant * self.current

    def drawn(self, command: Array) -> Array:
        """Return the current that the motors together take from the battery, (runs,) A."""
        return (command / self.nominal_voltage * self.current).sum(axis=-1)


def motors_of(effects: Concealed, group: str, axis: SwerveAxis, runs: int) -> Motors:
    """Return the motors of a group, `drive` or `steer`, as a case has them."""
    ratio = effects.get(f"motor_constant_error@{group}", "ratio")
    return Motors(
        gear_ratio=axis.gear_ratio,
        resistance=axis.motor.resistance,
        torque_constant=axis.motor.torque_constant * ratio,
        back_emf_constant=axis.motor.back_emf_constant * ratio,
        nominal_voltage=axis.motor.nominal_voltage,
        sagging=f"battery_sag@{group}" in effects,
        electrical=effects.get(f"motor_inductance@{group}", "time_constant"),
        limit=effects.get(f"current_limit@{group}", "limit"),
        current=np.zeros((runs, 4)),
    )


def shared_battery(
    effects: Concealed, motors: Motors, current: float, runs: int, random: np.random.Generator
) -> Battery:
    """Return the one battery, which gives way by the greater of what the two groups conceal."""
    groups = [effects.group(group) for group in ("drive", "steer")]
    worst = max(groups, key=lambda group: group.values.get("battery_sag", {}).get("drop", 0.0))
    return battery_of(worst, motors.nominal_voltage, current, runs, random)
