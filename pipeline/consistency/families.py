"""The redundancies of each kind of machine, in families that look at the same columns."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

from simgap.consistency.attitude import command_pairs, force_pairs, tilt_pairs, turning_pairs
from simgap.consistency.axes import joint_laws, swerve_laws
from simgap.consistency.kinematics import position_pairs, servo_pairs
from simgap.consistency.plausible import plausibility
from simgap.consistency.redundancy import Agreement, Pair, agreement_of
from simgap.consistency.rotors import rotor_laws, speed_laws
from simgap.consistency.samples import Samples
from simgap.consistency.wheels import wheel_pairs
from simgap.platforms.joint import Joint
from simgap.platforms.quadrotor import Quadrotor
from simgap.platforms.swerve import Swerve

Platform = Joint | Quadrotor | Swerve
Agreements = dict[str, Agreement]


@dataclass(frozen=True)
class Family:
    """Redundancies that look at the same columns.

    Attributes:
        stems: beginnings of the names of these columns; the time is always one of them.
        compare: yields the agreements.
    """

    stems: tuple[str, ...]
    compare: Callable[[Samples], Iterable[Agreement | None]]

    def sees(self, columns: Iterable[str]) -> bool:
        """Whether a change of some columns changes an agreement."""
        return any(column == "t" or column.startswith(self.stems) for column in columns)

    def agreements(self, samples: Samples) -> Agreements:
        """Return the agreements by name."""
        return {found.name: found for found in self.compare(samples) if found is not None}


def families_of(samples: Samples, platform: Platform | None) -> list[Family]:
    """Return the redundancies that a recording has, with the platform's where it is known."""
    nominal = nominal_voltage(platform)
    plain = Family(
        ("battery_voltage", "voltage", "drive_voltage", "steer_voltage", "motor_command"),
        lambda changed: plausibility(changed, nominal),
    )
    found = [plain]
    for needed, stems, pairs in _PAIRS[samples.kind]:
        if all(column in samples for column in needed):
            found.append(Family(stems, _compared(pairs)))
    if isinstance(platform, Joint) and "velocity" in samples:
        stems = ("position", "velocity", "effort", "voltage", "current")
        found.append(Family(stems, lambda changed: joint_laws(changed, platform)))
    elif isinstance(platform, Swerve):
        wheels = ("drive_velocity", "steer_angle", "chassis")
        found.append(Family(wheels, _compared(lambda changed: wheel_pairs(changed, platform))))
        for group in ("drive", "steer"):
            motors = (f"{group}_voltage", f"{group}_velocity")
            found.append(Family(motors, _swerve_motors(platform, group)))
    elif isinstance(platform, Quadrotor):
        for stem in ("motor_speed", "motor_command"):
            if samples.has(stem, "1234"):
                rotors = (stem, "attitude", "velocity", "body_rate", "specific_force")
                found.append(Family(rotors, _rotors(platform, stem)))
        motors = ("motor_speed", "motor_command")
        found.append(Family(motors, lambda changed: speed_laws(changed, platform)))
    return found


_PairsOf = Callable[[Samples], Iterable[Pair]]

_PAIRS: Mapping[str, Sequence[tuple[tuple[str, ...], tuple[str, ...], _PairsOf]]] = {
    "joint": [
        (("velocity",), ("position", "velocity"), position_pairs),
        (("position_command",), ("position_command", "position"), servo_pairs),
    ],
    "swerve": [(("steer_angle_1",), ("steer_angle", "steer_velocity"), position_pairs)],
    "quadrotor": [
        (("position_x",), ("position", "velocity"), position_pairs),
        (("attitude_w",), ("attitude", "body_rate"), turning_pairs),
        (("specific_force_x", "attitude_w"), ("attitude", "velocity", "specific_force"), force_pairs),
        (("velocity_x",), ("attitude", "velocity"), tilt_pairs),
        (("body_rate_command_x",), ("body_rate",), command_pairs),
    ],
}
"""By kind: the columns that tell whether a redundancy is there, the beginnings of all its columns, and its pairs."""


def _compared(pairs: _PairsOf) -> Callable[[Samples], Iterable[Agreement | None]]:
    return lambda samples: (agreement_of(pair) for pair in pairs(samples))


def _swerve_motors(platform: Swerve, group: str) -> Callable[[Samples], Iterable[Agreement | None]]:
    return lambda samples: swerve_laws(samples, platform, group)


def _rotors(platform: Quadrotor, stem: str) -> Callable[[Samples], Iterable[Agreement | None]]:
    return lambda samples: rotor_laws(samples, platform, stem)


def nominal_voltage(platform: Platform | None) -> float | None:
    """Return the voltage of a platform's supply, V, where it is known."""
    if isinstance(platform, Quadrotor):
        return platform.nominal_voltage
    return platform.drive.motor.nominal_voltage if isinstance(platform, Swerve) else None
