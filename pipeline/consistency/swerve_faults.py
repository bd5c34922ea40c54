"""What may have been done to the recording of a swerve drive."""

import numpy as np

from simgap.consistency.plausible import supply_of
from simgap.consistency.samples import Samples
from simgap.consistency.transformation import Transformation, scaled, taken
from simgap.consistency.units import ANGLE, ANGULAR_RATE, CLOCK, SPEED, VOLTAGE, duty, in_two_units, in_units
from simgap.platforms.swerve import Swerve

_SIGN = 0.06
_ONE_SIGN = 0.02  # one of four motors that was mounted the other way round
_ORDER = 0.004  # each of the exchanges of two modules or of sides
_GEAR = 0.05
_AXES = 0.02
_QUARTER = 0.01
_GROUPS = ("drive_voltage", "steer_voltage", "drive_velocity", "steer_velocity", "steer_angle")
_ORDERS = (
    "2134",
    "3214",
    "4231",
    "1324",
    "1432",
    "1243",
    "2143",
    "3412",
    "4321",
    "2341",
    "4123",
    "2413",
    "3142",
)


def swerve_faults(samples: Samples, swerve: Swerve | None) -> list[Transformation]:
    """Return the transformations of a swerve drive's columns.

    Args:
        samples: of the recording.
        swerve: the platform, where it is known.
    """
    found = [
        *in_units("steer_velocity_1..4", _four("steer_velocity"), ANGULAR_RATE),
        *in_units("steer_angle_1..4", _four("steer_angle"), ANGLE),
        *in_two_units(
            "steer_angle_1..4 and steer_velocity_1..4",
            ((_four("steer_angle"), ANGLE), (_four("steer_velocity"), ANGULAR_RATE)),
        ),
        *in_units("drive_velocity_1..4", _four("drive_velocity"), ANGULAR_RATE),
        *in_units("t", ("t",), CLOCK),
        *_signs(),
        *_orders(),
        *_voltages(samples, swerve),
        *_chassis(samples),
    ]
    return found + (_sides_of_gears(swerve) if swerve is not None else [])


def _four(stem: str) -> tuple[str, ...]:
    return tuple(f"{stem}_{module}" for module in "1234")


def _signs() -> list[Transformation]:
    found = []
    for stem in _GROUPS:
        found.append(taken("sign", f"{stem}_1..4", {name: f"-{name}" for name in _four(stem)}, _SIGN))
        found += [taken("sign", name, {name: f"-{name}"}, _ONE_SIGN) for name in _four(stem)]
    both = (*_four("steer_angle"), *_four("steer_velocity"))
    name = "steer_angle_1..4 and steer_velocity_1..4"
    found.append(taken("sign", name, {column: f"-{column}" for column in both}, _SIGN))
    return found


def _orders() -> list[Transformation]:
    """Return the exchanges of modules, of one group of columns or of a motor with its sensors."""
    groups: dict[str, tuple[str, ...]] = {f"{stem}_1..4": (stem,) for stem in _GROUPS}
    groups["steer_angle_1..4 and steer_velocity_1..4"] = ("steer_angle", "steer_velocity")
    found = []
    for name, stems in groups.items():
        for order in _ORDERS:
            sources = {
                f"{stem}_{here}": f"{stem}_{there}"
                for stem in stems
                for here, there in zip("1234", order, strict=True)
            }
            found.append(taken("motor_order", name, sources, _ORDER))
    return found


def _voltages(samples: Samples, swerve: Swerve | None) -> list[Transformation]:
    found = []
    supply = supply_of(samples)
    if np.isnan(supply) and swerve is not None:
        supply = swerve.drive.motor.nominal_voltage
    for stem in ("drive_voltage", "steer_voltage"):
        largest = float(np.nanquantile(np.abs(samples.stack(stem, "1234")), 0.999))
        found += in_units(f"{stem}_1..4", _four(stem), VOLTAGE)
        found += duty(f"{stem}_1..4", _four(stem), largest, supply)
    return found


def _chassis(samples: Samples) -> list[Transformation]:
    found = []
    x, y = "chassis_velocity_x", "chassis_velocity_y"
    if x in samples:
        found += in_units("chassis_velocity_x, chassis_velocity_y", (x, y), SPEED)
        found += [taken("sign", name, {name: f"-{name}"}, 0.5 * _SIGN) for name in (x, y)]
        for name, sources in {
            "x and y exchanged": {x: y, y: x},
            "turned to the left": {x: f"-{y}", y: x},
            "turned to the right": {x: y, y: f"-{x}"},
            "turned round": {x: f"-{x}", y: f"-{y}"},
        }.items():
            found.append(taken("axis_order", "chassis_velocity_x, chassis_velocity_y", sources, _AXES, name))
    if x in samples and "chassis_rate" in samples:
        found.append(_field_frame(x, y))
    if "chassis_rate" in samples:
        found += in_units("chassis_rate", ("chassis_rate",), ANGULAR_RATE)
        found.append(taken("sign", "chassis_rate", {"chassis_rate": "-chassis_rate"}, _SIGN))
    return found


def _field_frame(x: str, y: str) -> Transformation:
    """Return the transformation in which the chassis velocity is that in the frame of the field."""

    def mend(samples: Samples) -> dict[str, np.ndarray]:
        heading = samples.integral(samples["chassis_rate"])
        cosine, sine = np.cos(heading), np.sin(heading)
        return {x: cosine * samples[x] + sine * samples[y], y: -sine * samples[x] + cosine * samples[y]}

    remedy = f"Turn {x!r} and {y!r} into the frame of the robot by its heading."
    return Transformation("body_frame", f"{x}, {y}", (x, y), _AXES, mend, remedy, "in the frame of the field")


def _sides_of_gears(swerve: Swerve) -> list[Transformation]:
    drive, steer = swerve.drive.gear_ratio, swerve.steer.gear_ratio
    wheel, motor = "of the wheel, behind the gear", "of the motor, before the gear"
    metres = 1.0 / (drive / swerve.wheel_radius)
    speed = _four("drive_velocity")
    return [
        scaled("gear_ratio", "drive_velocity_1..4", speed, 1.0 / drive, _GEAR, f"scale: {drive:.4g}", wheel),
        scaled(
            "wheel_speed", "drive_velocity_1..4", speed, metres, _GEAR, f"scale: {1.0 / metres:.4g}", "in m/s"
        ),
        scaled(
            "gear_ratio",
            "steer_velocity_1..4",
            _four("steer_velocity"),
            steer,
            _GEAR,
            f"scale: {1 / steer:.4g}",
            motor,
        ),
        scaled(
            "gear_ratio",
            "steer_angle_1..4",
            _four("steer_angle"),
            steer,
            _GEAR,
            f"scale: {1 / steer:.4g}",
            motor,
        ),
        scaled(
            "gear_ratio",
            "steer_angle_1..4 and steer_velocity_1..4",
            (*_four("steer_angle"), *_four("steer_velocity")),
            steer,
            _GEAR,
            f"scale: {1 / steer:.4g}",
            motor,
        ),
        _turned_zero(0.5 * np.pi),
        _turned_zero(-0.5 * np.pi),
        _turned_zero(np.pi),
    ]


def _turned_zero(angle: float) -> Transformation:
    """Return the transformation in which a steer angle of zero points elsewhere than forward."""
    columns = _four("steer_angle")

    def mend(samples: Samples) -> dict[str, np.ndarray]:
        return {name: samples[name] + angle for name in columns}

    remedy = f"Add {np.degrees(angle):.0f}° to each of {', '.join(columns)}."
    return Transformation(
        "axis_order", "steer_angle_1..4", columns, _QUARTER, mend, remedy, "with zero to a side"
    )
