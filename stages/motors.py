"""The command that lists the motors that a platform may name; not a stage of the pipeline."""

import argparse
import sys
from pathlib import Path
from typing import NoReturn

from simgap.runner.command import report_mistakes


def motors(name: str | None = None) -> None:
    """List the motors that a platform file can name; with a name, print the keys of that motor."""
    from simgap.platforms.motor_table import motors_listing
    from simgap.platforms.motors import motor_named

    if name is None:
        print(motors_listing(), end="")
        return
    motor = motor_named(name, "motors")
    print(f"{motor.name}: {motor.source}")
    for use, keys in (("joint", motor.of_joint()), ("swerve drive", motor.of_axis())):
        print(f"  {use}: " + ", ".join(f"{key} {value:.6g}" for key, value in keys.items()))


def write(path: Path) -> None:
    """Write the table as a page in Markdown."""
    from simgap.platforms.motor_table import motors_page

    path.write_text(motors_page(), encoding="utf-8")
    print(f"motors: wrote {path}")


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command line and exit."""
    parser = argparse.ArgumentParser(prog="simgap motors", description=motors.__doc__)
    parser.add_argument("name", nargs="?", help="of a motor, for example NEO")
    parser.add_argument("--write", metavar="PATH", type=Path, help="write the table as a page in Markdown")
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    given = parser.parse_args(argv)
    action = (lambda: write(given.write)) if given.write else (lambda: motors(given.name))
    sys.exit(report_mistakes("motors", given.debug, action))


if __name__ == "__main__":
    main()
