"""The table of motors, for a terminal and for the documentation."""

from collections.abc import Sequence

from simgap.platforms.motors import NamedMotor, motors

_HEAD = """\
# Motors by name

A platform file may name a motor: `motor: NEO`. [Describe your platform](how_to/platform.md#a-motor-by-its-name)
shows how. The command `simgap motors --write docs/motors.md` generates this page from `pipeline/platforms/motors.yaml`.

The figures are those that makers publish. They hold at the nominal voltage.
Figures of a servo hold at its output. Its gear ratio is that inside of it.
Case, spaces and hyphens in a name do not matter.

A joint's resistance is the nominal voltage over the stall current.
Its torque constant is the back-EMF constant: (nominal voltage − resistance · free current) / free speed.
A free current that is not published counts as zero.
So friction and losses of the gear are not in the nominal model. A diagnosis finds them.
The nominal stall torque may therefore exceed the published one.
A swerve drive takes the four published figures as they are.

"""
_COLUMNS = ("motor", "V", "stall N·m", "stall A", "free rpm", "free A", "gear", "other names", "source")


def motors_page() -> str:
    """Return the page of the documentation, in Markdown."""
    lines = [_COLUMNS, ["---"] * len(_COLUMNS), *map(_row, motors())]
    return _HEAD + "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"


def motors_listing() -> str:
    """Return one line a motor, for a terminal."""
    rows: list[Sequence[str]] = [_COLUMNS[:-2], *(_row(motor)[:-2] for motor in motors())]
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    lines = [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]
    return "\n".join(lines) + "\n"


def _row(motor: NamedMotor) -> list[str]:
    current = "" if motor.free_current is None else f"{motor.free_current:g}"
    ratio = "" if motor.gear_ratio == 1.0 else f"{motor.gear_ratio:g}"
    figures = (motor.nominal_voltage, motor.stall_torque, motor.stall_current, motor.free_speed_rpm)
    shown = [f"{value:g}" for value in figures]
    return [motor.name, *shown, current, ratio, ", ".join(motor.also), motor.source]
