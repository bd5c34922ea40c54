"""Structs of WPILib: which number lies at which byte, by the schema that the log holds.

Source: WPILib, "Packed Struct Specification": fields follow each other without gaps, little end first; a field has a
type, a name, perhaps a length in brackets, and before the type perhaps an `enum {…}`.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

BUILT_IN: dict[str, str] = {
    "Translation2d": "double x;double y",
    "Rotation2d": "double value",
    "Pose2d": "Translation2d translation;Rotation2d rotation",
    "Twist2d": "double dx;double dy;double dtheta",
    "ChassisSpeeds": "double vx;double vy;double omega",
    "SwerveModuleState": "double speed;Rotation2d angle",
    "SwerveModulePosition": "double distance;Rotation2d angle",
}
"""Layouts of WPILib's own structs, for logs without schemas."""

_UNITS: dict[str, dict[str, str]] = {
    "Translation2d": {"x": "m", "y": "m"},
    "Translation3d": {"x": "m", "y": "m", "z": "m"},
    "Rotation2d": {"value": "rad"},
    "Quaternion": {"w": "1", "x": "1", "y": "1", "z": "1"},
    "Twist2d": {"dx": "m", "dy": "m", "dtheta": "rad"},
    "ChassisSpeeds": {"vx": "m/s", "vy": "m/s", "omega": "rad/s"},
    "SwerveModuleState": {"speed": "m/s"},
    "SwerveModulePosition": {"distance": "m"},
    "DifferentialDriveWheelSpeeds": {"left": "m/s", "right": "m/s"},
    "DifferentialDriveWheelPositions": {"left": "m", "right": "m"},
}  # WPILib, "Class reference": its geometry and kinematics are in m, rad and s

_NUMBERS = {
    "bool": "u1", "int8": "i1", "uint8": "u1", "int16": "<i2", "uint16": "<u2", "int32": "<i4", "uint32": "<u4",
    "int64": "<i8", "uint64": "<u8", "float": "<f4", "float32": "<f4", "double": "<f8", "float64": "<f8",
}  # fmt: skip
_FIELD = re.compile(r"(?:enum\s*\{[^}]*\}\s*)?(\w+)\s+(\w+)\s*(?:\[\s*(\d+)\s*\]|(:\s*\d+))?")
_MOST_NUMBERS = (
    256  # of one struct; a longer one holds no measurement, and its numbers would need much memory
)
_DEEPEST = 8  # structs within each other; the specification forbids that a struct holds itself


@dataclass(frozen=True)
class Number:
    """One number of a struct.

    Attributes:
        path: names from the outermost field on, with `/` between them.
        dtype: of numpy.
        offset: bytes from the beginning of the struct.
        unit: of WPILib's own structs; None elsewhere.
    """

    path: str
    dtype: str
    offset: int
    unit: str | None


@dataclass(frozen=True)
class Layout:
    """Where the numbers of a struct lie.

    Attributes:
        numbers: in the order of the struct.
        size: bytes of the struct.
    """

    numbers: tuple[Number, ...]
    size: int


def layout_of(name: str, schemas: Mapping[str, str]) -> Layout | None:
    """Return the layout of a struct; None where a schema is missing, has bit fields or makes no sense.

    Args:
        name: of the struct.
        schemas: text of each schema that the log holds, by the name of its struct.
    """
    numbers: list[Number] = []
    try:
        size = _add(name, schemas, "", 0, numbers, _DEEPEST)
    except (KeyError, ValueError):
        return None
    return Layout(tuple(numbers), size) if numbers and size else None


def _add(
    name: str, schemas: Mapping[str, str], prefix: str, offset: int, numbers: list[Number], deepest: int
) -> int:
    """Add the numbers of a struct that begins at a byte, and return the byte behind it."""
    if not deepest:
        raise ValueError("structs hold each other")
    units = _UNITS.get(name, {})
    for kind, field, count in _fields(schemas.get(name) or BUILT_IN[name]):
        names = [field] if count is None else [f"{field}[{place}]" for place in range(count)]
        if kind == "char":
            offset += count or 1
            continue
        for each in names:
            if kind in _NUMBERS:
                numbers.append(Number(prefix + each, _NUMBERS[kind], offset, units.get(field)))
                offset += int(_NUMBERS[kind][-1])
            else:
                offset = _add(kind, schemas, f"{prefix}{each}/", offset, numbers, deepest - 1)
            if len(numbers) > _MOST_NUMBERS:
                raise ValueError("too long")
    return offset


def _fields(schema: str) -> Iterator[tuple[str, str, int | None]]:
    """Yield the type, the name and the length of each field; None where it is no array."""
    for text in schema.split(";"):
        if not text.strip():
            continue
        found = _FIELD.fullmatch(text.strip())
        if found is None or found[4]:
            raise ValueError("a bit field, or no field")
        count = None if found[3] is None else int(found[3])
        if count is not None and count > _MOST_NUMBERS and found[1] != "char":
            raise ValueError("too long")
        yield found[1], found[2], count
