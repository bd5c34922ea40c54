"""The unit that a column's name carries: "speed [rad/s]", "Velocity (rpm)", "angle_deg", "coil_V", "acc_x_g"."""

import re

from simgap.recordings.units import conversion, usual_name

_BRACKETED = re.compile(r"[\[(<{]\s*([^\[\](){}<>]+?)\s*[\])>}]\s*([xyz]|\d+)?\s*$", re.IGNORECASE)

RAW = ("units", "unit", "counts", "count", "ticks", "tick", "raw", "lsb", "adc", "steps", "digits", "inc")
"""Words in brackets that say that a number is no physical quantity yet."""

FOREIGN = (
    "rad/s²", "deg/s²", "m/s³", "W", "Hz", "kHz", "kg", "Pa", "hPa", "kPa", "bar", "°F", "Ω", "J", "mAh", "Wh",
)  # fmt: skip
"""Units of quantities that no column has."""

_SPELLED = (
    "deg degree degrees rad rads radians rev turns rotations rpm rps dps rad/s deg/s m/s mm/s cm/s in/s ft/s m/s2 "
    "m/s^2 sec secs seconds ms msec millis us usec micros ns nsec nanos mm cm meters metres volt volts amp amps "
    "newtons kgcm celsius percent"
)
_ENDINGS = {word: usual_name(word) for word in _SPELLED.split()} | {
    "degs": "deg", "revs": "rev",
    "rad_s": "rad/s", "radps": "rad/s", "rad_per_s": "rad/s", "rad_per_sec": "rad/s", "rad_sec": "rad/s",
    "deg_s": "deg/s", "degps": "deg/s", "deg_per_s": "deg/s", "deg_per_sec": "deg/s", "deg_sec": "deg/s",
    "rev_s": "rev/s", "rot_s": "rev/s", "turns_s": "rev/s", "rev_per_s": "rev/s", "rev_per_sec": "rev/s",
    "rot_per_sec": "rev/s", "rotations_per_sec": "rev/s",
    "m_s": "m/s", "mps": "m/s", "m_per_s": "m/s", "m_per_sec": "m/s", "meters_per_sec": "m/s",
    "mm_s": "mm/s", "cm_s": "cm/s",
    "in_s": "in/s", "inps": "in/s", "in_per_s": "in/s", "in_per_sec": "in/s", "inches_per_sec": "in/s",
    "ft_s": "ft/s", "ftps": "ft/s", "ft_per_s": "ft/s", "ft_per_sec": "ft/s", "feet_per_sec": "ft/s",
    "m_s2": "m/s²", "m_s^2": "m/s²", "mps2": "m/s²", "mss": "m/s²", "m_per_s2": "m/s²", "m_s_2": "m/s²",
    "rad_s2": "rad/s²", "rad/s2": "rad/s²", "rad/s^2": "rad/s²", "radps2": "rad/s²", "rad_per_s2": "rad/s²",
    "deg_s2": "deg/s²", "deg/s2": "deg/s²", "deg/s^2": "deg/s²", "m_s3": "m/s³",
    "inch": "in", "inches": "in", "feet": "ft",
    "mv": "mV", "ma": "mA", "nm": "N·m", "n m": "N·m", "mnm": "mN·m", "ncm": "N·cm", "kg_cm": "kgf·cm",
    "degc": "°C", "deg_c": "°C", "kelvin": "K", "degf": "°F", "deg_f": "°F", "fahrenheit": "°F", "pct": "percent",
    "hz": "Hz", "khz": "kHz", "watts": "W", "watt": "W", "kg": "kg", "pa": "Pa", "hpa": "hPa", "kpa": "kPa",
    "mah": "mAh", "wh": "Wh", "ohm": "Ω", "ohms": "Ω",
}  # fmt: skip
"""Last words that are a unit beside any quantity, in lower case."""

_TIME = r"time|stamp|elapsed|clock|zeit|(?:^|[^a-z])t$"
_LENGTH = (
    r"pos|dist|travel|disp|length|height|alt|odom|stroke|extension|slide|carriage|(?:^|[^a-z])p?[xyzned]$"
)
_ACCELERATION = r"acc|imu|gravity|(?:^|[^a-z])a[xyz]?$"
_FORCE = r"force|thrust|load|lift|drag|effort"
_TORQUE = r"torque|tau|trq|effort|moment|load|drive|motor"
_CURRENT = r"cur|amp|strom|bat|supply|bus|total|(?:^|[^a-z])i[qd]?(?:$|[^a-z])"
_VOLTAGE = r"volt|bat|supply|bus|coil|winding|terminal|armature|cell|spannung"

_BESIDE: tuple[tuple[str, str, str], ...] = (
    ("V", "V", r"^(?!.*(?:phase|hall|channel|ch)[^a-z]*$)"),  # phases are named U, V, W
    ("v", "V", _VOLTAGE),
    ("A", "A", _CURRENT),  # beside others, A is the first of several
    ("a", "A", "current"),
    ("g", "g", _ACCELERATION),  # a mass is in gram
    ("G", "g", _ACCELERATION),
    ("mg", "mg", _ACCELERATION),
    ("ms2", "m/s²", _ACCELERATION),
    ("N_m", "N·m", _TORQUE),
    ("n_m", "N·m", _TORQUE),  # else a position to the north
    ("s", "s", _TIME),
    ("m", "m", _LENGTH),
    ("in", "in", r"dist|travel|height|odom|(?:^|[^a-z])[xyz]$"),  # else it is an input
    ("ft", "ft", _LENGTH),
    ("fps", "ft/s", r"vel|speed"),  # else frames per second
    ("N", "N", _FORCE),
    ("W", "W", r"power|leistung"),
    ("C", "°C", "temp"),
    ("c", "°C", "temp"),
    ("F", "°F", "temp"),
    ("K", "K", "temp"),
    ("rot", "rev", r"pos|angle|motor|rotor|wheel|drive|steer|encoder"),  # else a rotation
)
"""Last words as they are written, the unit, and what has to stand before them for it to be one."""

_SPEED = re.compile("vel|speed|gyr|omega|rate")
_OF_SPEEDS = {"ms": "m/s", "rads": "rad/s", "degs": "deg/s"}  # what else are milliseconds, radians, degrees
_PLACE = re.compile(r"(?:[_\-. ]([xyz])|[_\-. ]?(\[\d+\]|\d+))$")  # "q_rad[0]", "acc_g_x"


def unit_in(name: str) -> str | None:
    """Return the unit that a name says, in brackets or by a last word that can mean nothing else; None where none.

    Words for raw numbers in brackets, such as "counts", and units of `FOREIGN` are returned: they have no conversion.
    """
    return _split(name)[1]


def quantity_words(name: str) -> str:
    """Return a name without the unit that it carries."""
    return _split(name)[0]


def _split(name: str) -> tuple[str, str | None]:
    """Return what a name says beside its unit, and the unit; the whole name and None where it says none."""
    bracketed = _BRACKETED.search(name)
    if bracketed and (unit := _unit_of(bracketed[1])) is not None:
        return name[: bracketed.start()] + (bracketed[2] or ""), unit
    found = _ending(name) or _ending(_parted(name))
    if found is None and (place := _PLACE.search(name)):
        found = _ending(name[: place.start()])
        if found and (place[1] or found[1] not in ("s", "m", "V", "A")):  # "joint_A_1" is no current
            return found[0] + place[0], found[1]
        return name, None
    return found or (name, None)


def _unit_of(word: str) -> str | None:
    """Return the unit that a word in brackets is; None where it is another word."""
    if word.isdigit():
        return None
    known = next((form for form in (word, word.lower()) if conversion(form) is not None), None)
    if known is not None:
        return known
    return (
        word.lower() if word.lower() in RAW else _ENDINGS.get(word.lower(), word if word in FOREIGN else None)
    )


def _ending(name: str) -> tuple[str, str] | None:
    """Return a name without its last word, and the unit that this word means; None where it means none."""
    text = name.strip()
    for ending, unit in _LONGEST:
        if found := re.search(rf"(?:^|[_\-. /,])\s*{re.escape(ending)}$", text.lower()):
            rest = text[: found.start()]
            return rest, _OF_SPEEDS.get(ending, unit) if _SPEED.search(rest.lower()) else unit
    for ending, unit, beside in _BESIDE:
        if found := re.search(rf"[_\-. /,]\s*{re.escape(ending)}$", text):
            rest = text[: found.start()]
            if re.search(beside, rest.lower()):
                return rest, unit
    return None


def _parted(name: str) -> str:
    """Return a name with its words apart: "VelocityRadPerSec" is Velocity_Rad_Per_Sec."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name.strip())


_LONGEST = sorted(_ENDINGS.items(), key=lambda pair: -len(pair[0]))
