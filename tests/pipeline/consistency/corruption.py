"""Corruptions of good recordings: how logs come to be wrong, and what has to be said of each.

They are written apart from the check: nothing here is taken from `simgap.consistency`.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
from scipy.spatial.transform import Rotation

from simgap.recordings.recording import Recording

DEGREE, TURN, RPM = 180.0 / np.pi, 0.5 / np.pi, 30.0 / np.pi
FOOT, INCH, GRAVITY = 0.3048, 0.0254, 9.80665

Change = Callable[[pd.DataFrame, dict[str, Any]], pd.DataFrame]


@dataclass(frozen=True)
class Corruption:
    """A way to spoil a recording.

    Attributes:
        name: in the table.
        change: of the frame, given the platform file.
        causes: `suspected` that are right, the same fault in other words among them.
        column: that has to be in the name of what is found first.
        needs: columns without which it is not possible.
        motor: whether the platform needs a motor.
        sliding: True or False where only a position in m or in rad can be spoilt so.
        driven: how large a column has to become, at least; a motor that is never driven hard shows no full duty.
    """

    name: str
    change: Change
    causes: tuple[str, ...]
    column: tuple[str, ...]
    needs: tuple[str, ...] = ()
    motor: bool = False
    sliding: bool | None = None
    driven: dict[str, float] = field(default_factory=dict)

    def possible(self, recording: Recording, platform: dict[str, Any]) -> bool:
        """Whether a recording can be spoilt in this way."""
        sliding = recording.units.get("position") == "m"
        return (
            set(self.needs) <= set(recording.channels)
            and (not self.motor or "motor" in platform)
            and self.sliding in (None, sliding)
            and (recording.kind != "swerve" or "steer" not in self.column[0] or _steers(recording))
            and all(_size(recording, column) >= least for column, least in self.driven.items())
        )

    def of(self, recording: Recording, platform: dict[str, Any]) -> Recording:
        """Return the spoilt recording."""
        return replace(recording, frame=self.change(recording.frame.copy(), platform))


def _steers(recording: Recording) -> bool:
    """Whether the modules turn at all: what is done to columns of zeros cannot be seen."""
    return bool(recording.frame["steer_angle_1"].std() > 0.05)


def _size(recording: Recording, column: str) -> float:
    return float(recording.frame[column].abs().quantile(0.999))


def names(stem: str, suffixes: str) -> tuple[str, ...]:
    return tuple(f"{stem}_{suffix}" for suffix in suffixes)


def times(factor: float | Callable[[dict[str, Any]], float], *columns: str) -> Change:
    def change(frame: pd.DataFrame, platform: dict[str, Any]) -> pd.DataFrame:
        scale = factor(platform) if callable(factor) else factor
        return frame.assign(**{column: scale * frame[column] for column in columns})

    return change


def takes(**sources: str) -> Change:
    """Return the change in which columns hold others; a minus turns the sign."""

    def change(frame: pd.DataFrame, platform: dict[str, Any]) -> pd.DataFrame:
        return frame.assign(
            **{c: -frame[s[1:]] if s.startswith("-") else frame[s] for c, s in sources.items()}
        )

    return change


def flipped(*stems: str) -> dict[str, str]:
    return {f"{stem}_{axis}": f"-{stem}_{axis}" for stem in stems for axis in "yz"}


def ordered(order: str, *stems: str) -> Change:
    pairs = {f"{stem}_{a}": f"{stem}_{b}" for stem in stems for a, b in zip("1234", order, strict=True)}
    return takes(**pairs)


def _attitude(frame: pd.DataFrame) -> Rotation:
    return Rotation.from_quat(
        frame[list(names("attitude", "wxyz"))].ffill().bfill().to_numpy(copy=True), scalar_first=True
    )


def turned(stem: str, inverse: bool, lift: float = 0.0) -> Change:
    """Return the change in which a vector is in the other frame, with `lift` taken off its z axis in the world."""

    def change(frame: pd.DataFrame, platform: dict[str, Any]) -> pd.DataFrame:
        columns = list(names(stem, "xyz"))
        vectors = _attitude(frame).apply(frame[columns].to_numpy(copy=True), inverse=inverse) - [
            0.0,
            0.0,
            lift,
        ]
        return frame.assign(**dict(zip(columns, vectors.T, strict=True)))

    return change


def weightless(frame: pd.DataFrame, platform: dict[str, Any]) -> pd.DataFrame:
    columns = list(names("specific_force", "xyz"))
    gravity = _attitude(frame).apply([0.0, 0.0, GRAVITY], inverse=True)
    return frame.assign(**dict(zip(columns, (frame[columns].to_numpy() - gravity).T, strict=True)))


def field_frame(frame: pd.DataFrame, platform: dict[str, Any]) -> pd.DataFrame:
    step = frame.groupby("run")["t"].diff().fillna(0.0)
    heading = (step * frame["chassis_rate"].fillna(0.0)).groupby(frame["run"]).cumsum()
    x, y = frame["chassis_velocity_x"], frame["chassis_velocity_y"]
    cosine, sine = np.cos(heading), np.sin(heading)
    return frame.assign(chassis_velocity_x=cosine * x - sine * y, chassis_velocity_y=sine * x + cosine * y)


def pulses(frame: pd.DataFrame, platform: dict[str, Any]) -> pd.DataFrame:
    return frame.assign(**{c: 1000.0 + 1000.0 * frame[c] for c in names("motor_command", "1234")})


def squared(frame: pd.DataFrame, platform: dict[str, Any]) -> pd.DataFrame:
    return frame.assign(**{c: frame[c] ** 2 for c in names("motor_command", "1234")})


def gear(platform: dict[str, Any]) -> float:
    return float(platform["motor"]["gear_ratio"])


def _joint() -> Iterator[Corruption]:
    rates = {"degrees": DEGREE, "rotations": TURN, "turns_per_minute": RPM}
    for cause, factor in rates.items():
        yield Corruption(
            f"velocity in {cause}", times(factor, "velocity"), (cause,), ("velocity",), sliding=False
        )
    for cause, factor in {"degrees": DEGREE, "rotations": TURN}.items():
        yield Corruption(
            f"position in {cause}", times(factor, "position"), (cause,), ("position",), sliding=False
        )
    both = ("position and velocity",)
    for cause, factor in {"degrees": DEGREE, "rotations": TURN}.items():
        # With an effort alone, rotations are an inertia 6.3 times as large: no redundancy tells.
        alone = factor == DEGREE
        change = times(factor, "position", "velocity")
        yield Corruption(f"both in {cause}", change, (cause,), both, motor=not alone, sliding=False)
    for column in ("position", "velocity"):
        change = times(1000.0, column)
        yield Corruption(f"{column} in mm", change, ("millimetres",), (column,), sliding=True)
        causes = ("sign",)
        yield Corruption(f"{column} negative", times(-1.0, column), causes, ("position", "velocity"))
    yield Corruption(
        "both in mm", times(1000.0, "position", "velocity"), ("millimetres",), both, sliding=True
    )
    yield Corruption(
        "velocity in inches", times(1 / INCH, "velocity"), ("inches",), ("velocity",), sliding=True
    )
    yield Corruption(
        "velocity of the motor", times(gear, "velocity"), ("gear_ratio",), ("velocity",), motor=True
    )
    yield Corruption(
        "position of the motor", times(gear, "position"), ("gear_ratio",), ("position",), motor=True
    )
    yield Corruption(
        "both of the motor", times(gear, *both[0].split(" and ")), ("gear_ratio",), both, motor=True
    )
    for column in ("effort", "voltage"):
        yield Corruption(
            f"{column} negative",
            times(-1.0, column),
            ("sign",),
            (column, *both),
            (column,),
            column == "voltage",
        )
        yield Corruption(
            f"{column} in thousandths",
            times(1000.0, column),
            ("milli",),
            (column,),
            (column,),
            column == "voltage",
        )
    hard = {"voltage": 6.0}
    yield Corruption(
        "duty of 12 V", times(1 / 12, "voltage"), ("duty",), ("voltage",), ("voltage",), True, driven=hard
    )
    yield Corruption(
        "percent of 12 V",
        times(100 / 12, "voltage"),
        ("percent",),
        ("voltage",),
        ("voltage",),
        True,
        driven=hard,
    )
    yield from _clocks()


def _clocks() -> Iterator[Corruption]:
    for unit, factor in {"ms": 1e3, "us": 1e6}.items():
        yield Corruption(f"time in {unit}", times(factor, "t"), ("time_unit",), ("t",))


def _swerve() -> Iterator[Corruption]:
    rate, angle, speed = (names(stem, "1234") for stem in ("steer_velocity", "steer_angle", "drive_velocity"))
    for cause, factor in {"degrees": DEGREE, "rotations": TURN, "turns_per_minute": RPM}.items():
        yield Corruption(f"steer_velocity in {cause}", times(factor, *rate), (cause,), ("steer_velocity",))
    for cause, factor in {"degrees": DEGREE, "rotations": TURN}.items():
        yield Corruption(f"steer_angle in {cause}", times(factor, *angle), (cause,), ("steer_angle",))
        yield Corruption(
            f"both of steering in {cause}", times(factor, *angle, *rate), (cause,), ("steer_angle",)
        )
    yield Corruption("steer_velocity negative", times(-1.0, *rate), ("sign",), ("steer_velocity",))
    yield Corruption("steer_angle negative", times(-1.0, *angle), ("sign",), ("steer_angle",))
    for cause, factor in {"rotations": TURN, "turns_per_minute": RPM}.items():
        yield Corruption(f"drive_velocity in {cause}", times(factor, *speed), (cause,), ("drive_velocity",))
    wheel = times(lambda platform: 1.0 / platform["drive"]["gear_ratio"], *speed)
    yield Corruption("drive_velocity of the wheel", wheel, ("gear_ratio",), ("drive_velocity",))
    ground = times(lambda p: p["wheel_radius"] / p["drive"]["gear_ratio"], *speed)
    yield Corruption("drive_velocity in m/s", ground, ("wheel_speed",), ("drive_velocity",))
    for group in ("drive", "steer"):
        volts = names(f"{group}_voltage", "1234")
        stem = f"{group}_voltage"
        yield Corruption(f"{stem} negative", times(-1.0, *volts), ("sign",), (stem,))
        yield Corruption(f"{stem} in mV", times(1000.0, *volts), ("milli",), (stem,))
        yield Corruption(f"{stem} as a duty", times(1 / 12, *volts), ("duty",), (stem,))
        yield Corruption(f"{stem} in percent", times(100 / 12, *volts), ("percent",), (stem,))
        yield Corruption(f"{stem} of 2 negative", times(-1.0, volts[1]), ("sign",), (volts[1],))
    yield Corruption("drive_velocity of 3 negative", times(-1.0, speed[2]), ("sign",), (speed[2],))
    yield Corruption("steer_velocity of 1 negative", times(-1.0, rate[0]), ("sign",), (rate[0],))
    yield Corruption(
        "angles of 1 and 2 exchanged", ordered("2134", "steer_angle"), ("motor_order",), ("steer_angle",)
    )
    yield Corruption(
        "speeds front to back", ordered("3412", "drive_velocity"), ("motor_order",), ("drive_velocity",)
    )
    x, y, turning = "chassis_velocity_x", "chassis_velocity_y", "chassis_rate"
    yield Corruption("chassis in feet", times(1 / FOOT, x, y), ("feet",), ("chassis",), (x,))
    yield Corruption("chassis axes exchanged", takes(**{x: y, y: x}), ("axis_order",), ("chassis",), (x,))
    yield Corruption("chassis of the field", field_frame, ("body_frame",), ("chassis",), (x, turning))
    yield Corruption("chassis x negative", times(-1.0, x), ("sign",), (x,), (x,))
    yield Corruption("chassis_rate in degrees", times(DEGREE, turning), ("degrees",), (turning,), (turning,))
    yield Corruption("chassis_rate negative", times(-1.0, turning), ("sign",), (turning,), (turning,))
    yield from _batteries()
    yield from _clocks()


def _batteries() -> Iterator[Corruption]:
    battery = "battery_voltage"
    yield Corruption("battery in mV", times(1000.0, battery), ("milli",), (battery,), (battery,))


def _quadrotor() -> Iterator[Corruption]:
    velocity, position, rate, force = (
        names(stem, "xyz") for stem in ("velocity", "position", "body_rate", "specific_force")
    )
    lengths = {"millimetres": 1e3, "centimetres": 1e2, "feet": 1 / FOOT}
    for cause, factor in lengths.items():
        yield Corruption(f"velocity in {cause}", times(factor, *velocity), (cause,), ("velocity",))
        yield Corruption(f"position in {cause}", times(factor, *position), (cause,), ("position",))
        yield Corruption(
            f"both in {cause}", times(factor, *position, *velocity), (cause,), ("position and velocity",)
        )
    yield Corruption("velocity in the body", turned("velocity", True), ("body_frame",), ("velocity",))
    yield Corruption("velocity_z negative", times(-1.0, "velocity_z"), ("sign",), ("velocity_z",))
    yield Corruption("velocity north-east-down", takes(**flipped("velocity")), ("frame",), ("velocity",))
    both = takes(**flipped("velocity", "position"))
    yield Corruption("both north-east-down", both, ("frame",), ("position and velocity",))
    w, x, y, z = names("attitude", "wxyz")
    yield Corruption("w last", takes(**{w: x, x: y, y: z, z: w}), ("quaternion_order",), ("attitude",))
    inverse = takes(**{part: f"-{part}" for part in (x, y, z)})
    yield Corruption("inverse attitude", inverse, ("conjugate",), ("attitude",))
    for cause, factor in {"degrees": DEGREE, "rotations": TURN}.items():
        yield Corruption(f"body_rate in {cause}", times(factor, *rate), (cause,), ("body_rate",))
    yield Corruption("body_rate_y negative", times(-1.0, "body_rate_y"), ("sign",), ("body_rate_y",))
    yield Corruption(
        "body_rate forward-right-down", takes(**flipped("body_rate")), ("frame",), ("body_rate",)
    )
    everything = {"attitude_y": "-attitude_y", "attitude_z": "-attitude_z"}
    everything |= flipped("position", "velocity", "body_rate")
    yield Corruption(
        "all north-east-down", _all_flipped(everything), ("frame",), ("position, velocity, attitude",)
    )
    need = force[:1]
    yield Corruption("force in g", times(1 / GRAVITY, *force), ("g_units",), ("specific_force",), need)
    yield Corruption("force in mg", times(1e3 / GRAVITY, *force), ("g_units",), ("specific_force",), need)
    yield Corruption("force without gravity", weightless, ("missing_gravity",), ("specific_force",), need)
    lifted = turned("specific_force", False, GRAVITY)
    yield Corruption(
        "force in the world, no gravity", lifted, ("missing_gravity",), ("specific_force",), need
    )
    down = takes(**flipped("specific_force"))
    yield Corruption("force forward-right-down", down, ("frame",), ("specific_force",), need)
    # Without drag a quadrotor feels nothing along x: turned round, or forward-right-down, is the same there.
    yield Corruption("force negative", times(-1.0, *force), ("sign", "frame"), ("specific_force",), need)
    yield from _rotors()
    yield from _batteries()
    cells = times(
        lambda p: 3.7 / p["nominal_voltage"] if p["nominal_voltage"] > 6 else np.nan, "battery_voltage"
    )
    yield Corruption(
        "battery of one cell",
        cells,
        ("per_cell",),
        ("battery_voltage",),
        ("battery_voltage",),
        driven={"battery_voltage": 6.0},
    )
    yield from _clocks()


def _all_flipped(sources: dict[str, str]) -> Change:
    def change(frame: pd.DataFrame, platform: dict[str, Any]) -> pd.DataFrame:
        force = flipped("specific_force") if "specific_force_x" in frame else {}
        return takes(**(sources | force))(frame, platform)

    return change


def _rotors() -> Iterator[Corruption]:
    speed, command = names("motor_speed", "1234"), names("motor_command", "1234")
    for order in ("2143", "3412", "4321", "2341", "1324"):

        def change(frame: pd.DataFrame, platform: dict[str, Any], order: str = order) -> pd.DataFrame:
            stems = [stem for stem in ("motor_speed", "motor_command") if f"{stem}_1" in frame]
            return ordered(order, *stems)(frame, platform)

        yield Corruption(f"motors in order {order}", change, ("motor_order",), ("motor",))
    for cause, factor in {"turns_per_minute": RPM, "rotations": TURN}.items():
        yield Corruption(f"motor_speed in {cause}", times(factor, *speed), (cause,), ("motor_speed",), speed)
    scales = {"percent": 100.0, "full_scale": 65535.0}
    for cause, factor in scales.items():
        yield Corruption(
            f"motor_command {cause}", times(factor, *command), (cause,), ("motor_command",), command
        )
    yield Corruption(
        "motor_command in 1/2000", times(2000.0, *command), ("full_scale",), ("motor_command",), command
    )
    yield Corruption("motor_command in pulses", pulses, ("pulse_width",), ("motor_command",), command)
    yield Corruption("motor_command of thrust", squared, ("thrust_command",), ("motor_command",), command)


CORRUPTIONS: dict[str, tuple[Corruption, ...]] = {
    "joint": tuple(_joint()),
    "swerve": tuple(_swerve()),
    "quadrotor": tuple(_quadrotor()),
}
"""The corruptions of each kind."""
