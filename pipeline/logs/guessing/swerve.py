"""A swerve drive in a log of no known layout: four modules, each with a drive and a steering motor, by name."""

from simgap.logs.guessing.inputs import supply_of
from simgap.logs.guessing.parts import named_signals
from simgap.logs.guessing.words import Said, words_of
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposal, Proposed, lacking
from simgap.recordings.contract import COLUMNS
from simgap.recordings.units import conversion

_MODULES = (
    ("1", ("fl", "lf", "frontleft", "leftfront"), ("front", "left")),
    ("2", ("fr", "rf", "frontright", "rightfront"), ("front", "right")),
    ("3", ("bl", "rl", "lb", "lr", "backleft", "rearleft"), ("back", "left")),
    ("4", ("br", "rr", "rb", "backright", "rearright"), ("back", "right")),
)
_DRIVE = frozenset(("drive", "driving", "wheel"))
_STEER = frozenset(("steer", "steering", "turn", "turning", "azimuth", "rotation", "angle", "swivel"))
_FEWEST = 8  # of the 20 required columns; fewer may be any four motors
_ORDER = "Modules are taken as front left, front right, back left, back right: module_positions need the same order."
_RATIO = "drive.gear_ratio / wheel_radius"
_BEHIND = (
    "The drive speeds are over the floor; gear ratio and wheel radius of the platform make them the motors'."
)


def propose_swerve(log: Log, said: dict[str, Said]) -> Proposal | None:
    """Propose the columns of a swerve drive; None where too few names say a module and its motor.

    Args:
        log: with times in s.
        said: what the names of its signals say, without those of the clock.
    """
    columns: dict[str, Proposed] = {}
    missing: dict[str, str] = {}
    numbered = _first_number(said)
    for name, entry in said.items():
        column = _column(name, entry, numbered)
        if column is None or entry.commanded or entry.other:
            continue
        found = _proposed(log.signals[name], column)
        if found is None:
            missing[column] = f"{name!r} has another unit"
        elif column not in columns or found.confidence > columns[column].confidence:
            columns[column] = found
    if len(columns) + len(missing) < _FEWEST:
        return None
    battery = supply_of(log, named_signals(said), ())
    if battery is not None:
        columns["battery_voltage"] = battery
    lost = lacking("swerve", set(columns))
    missing = {name: missing.get(name, f"log {name.replace('_', ' ')} of each module") for name in lost}
    behind = any(found.source.ratio for found in columns.values())
    return Proposal("swerve", columns, missing, notes=(_ORDER, _BEHIND) if behind else (_ORDER,))


def _first_number(said: dict[str, Said]) -> int:
    """Return whether modules are counted from 0 or from 1."""
    return 0 if any("0" in words_of(name) and _motor(name) for name in said) else 1


def _motor(name: str) -> str | None:
    words = set(words_of(name))
    if words & _DRIVE:
        return "drive"
    return "steer" if words & _STEER else None


def _column(name: str, said: Said, first: int) -> str | None:
    motor, module = _motor(name), _module(words_of(name), first)
    quantity = {"velocity": "velocity", "voltage": "voltage", "current": "current", "position": "angle"}.get(
        said.quantity
    )
    if motor is None or module is None or quantity is None:
        return None
    column = f"{motor}_{quantity}_{module}"
    return column if column in COLUMNS["swerve"] else None


def _module(words: tuple[str, ...], first: int) -> str | None:
    have = set(words)
    for number, short, pair in _MODULES:
        rear = tuple("rear" if word == "back" else word for word in pair)
        if have & set(short) or set(pair) <= have or set(rear) <= have:
            return number
    digits = [int(word) - first + 1 for word in words if word.isdigit() and len(word) == 1]
    return str(digits[0]) if len(digits) == 1 and 1 <= digits[0] <= 4 else None


def _proposed(signal: Signal, column: str) -> Proposed | None:
    expected = COLUMNS["swerve"][column]
    found = conversion(signal.unit) if signal.unit else None
    if found is not None:
        if found[0] == "m/s" and column.startswith("drive_velocity"):
            source = Source(signal.name, "rad/s", scale=found[1], ratio=_RATIO)
            return Proposed(
                source, 0.93, f"a speed over the floor in {signal.unit}, times gear ratio over wheel radius"
            )
        if found[0] != expected:
            return None
        return Proposed(Source(signal.name, signal.unit), 0.93, f"by its name, in {signal.unit}")
    sure = 0.91 if expected == "V" else 0.6
    return Proposed(Source(signal.name, expected), sure, f"by its name; {expected} is taken, no unit is said")
