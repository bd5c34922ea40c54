"""What a DataFlash log says of the vehicle, and of the units of its fields."""

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from numpy.typing import NDArray

if TYPE_CHECKING:
    from simgap.logs.readers.dataflash_message import Message

_PARAMETERS = ("FRAME", "MOT_", "LOG_BITMASK", "SERVO", "RC3_MIN", "RC3_MAX", "Q_ENABLE", "BRD_TYPE")
_VEHICLES = ("Copter", "Plane", "Rover", "Sub", "Tracker", "Blimp")
_VERSION = re.compile(r" [vV]\d")
_UNITS = {"m/s/s": "m/s²", "degheading": "deg", "d": "deg", "rad/s": "rad/s", "deg/s": "deg/s"}
"""Labels of the log that this package spells differently."""
_NAMED = ("deg", "m", "m/s", "rad", "V", "A", "rpm", "s")


def facts_of(messages: "Mapping[str, Message]") -> dict[str, str]:
    """Return firmware, vehicle, frame, and the parameters that concern motors and logging."""
    facts: dict[str, str] = {}
    for text in texts_of(messages):
        vehicle = next((name for name in _VEHICLES if name in text), None)
        if vehicle is not None and "firmware" not in facts and _VERSION.search(text):
            facts |= {"firmware": text, "vehicle": vehicle}
        if text.startswith("Frame:"):
            facts.setdefault("frame", text.removeprefix("Frame:").strip())
    for name, value in parameters_of(messages).items():
        if name.startswith(_PARAMETERS):
            facts[name] = f"{value:.6g}"
    return facts


def texts_of(messages: "Mapping[str, Message]") -> list[str]:
    """Return the messages for the pilot, in order."""
    if "MSG" not in messages or not _holds(messages["MSG"].rows, "Message", "S"):
        return []
    return [_text(raw) for raw in messages["MSG"].rows["Message"].tolist()]


def _holds(rows: NDArray[Any], field: str, types: str) -> bool:
    """Whether records have a field of one of some types: in a damaged log it may be of any."""
    return field in (rows.dtype.names or ()) and rows.dtype[field].kind in types


def parameters_of(messages: "Mapping[str, Message]") -> dict[str, float]:
    """Return the parameters; the last value of each."""
    if "PARM" not in messages:
        return {}
    rows = messages["PARM"].rows
    if not (_holds(rows, "Name", "S") and _holds(rows, "Value", "iuf")):
        return {}
    names, values = rows["Name"].tolist(), rows["Value"].astype("float64").tolist()
    return {_text(name): value for name, value in zip(names, values, strict=True)}


def declared_units(messages: "Mapping[str, Message]") -> dict[str, dict[str, str]]:
    """Return the declared unit of each field of each message; `#` for the one that counts instances."""
    if not {"FMT", "FMTU", "UNIT"} <= set(messages):
        return {}
    try:
        labels = {chr(int(row["Id"]) & 0xFF): _text(bytes(row["Label"])) for row in messages["UNIT"].rows}
        names = {int(row["Type"]): _text(bytes(row["Name"])) for row in messages["FMT"].rows}
        return {
            names[int(row["FmtType"])]: _units(row, messages[names[int(row["FmtType"])]], labels)
            for row in messages["FMTU"].rows
            if names.get(int(row["FmtType"])) in messages
        }
    except (ValueError, KeyError, TypeError):  # other fields than these records have
        return {}


def _units(row: Any, message: "Message", labels: dict[str, str]) -> dict[str, str]:
    found = {}
    for column, letter in zip(message.rows.dtype.names or (), _text(bytes(row["UnitIds"])), strict=False):
        label = labels.get(letter, "")
        unit = _UNITS.get(label, label if label in _NAMED else "")
        if letter == "#" or unit:
            found[column] = "#" if letter == "#" else unit
    return found


def _text(raw: Any) -> str:
    return bytes(raw).partition(b"\0")[0].decode("ascii", "replace").strip()
