"""The unit that a column's name carries: "speed [rad/s]", "Velocity (rpm)", "angle_deg", "t_ms"."""

import re

from simgap.recordings.units import conversion

_BRACKETED = re.compile(r"[\[(<{]\s*([^\[\](){}<>]+?)\s*[\])>}]\s*$")

RAW = ("units", "unit", "counts", "count", "ticks", "tick", "raw", "lsb", "adc", "steps", "digits", "inc")
"""Words in brackets that say that a number is no physical quantity yet."""

_ENDINGS = {
    "deg": "deg", "degs": "deg", "degree": "deg", "degrees": "deg", "rad": "rad", "rads": "rad", "radians": "rad",
    "rev": "rev", "revs": "rev", "rot": "rev", "turns": "rev", "rotations": "rev",
    "rpm": "rpm", "rps": "rev/s", "dps": "deg/s",
    "rad/s": "rad/s", "rad_s": "rad/s", "radps": "rad/s", "rad_per_s": "rad/s", "rad_per_sec": "rad/s",
    "deg/s": "deg/s", "deg_s": "deg/s", "degps": "deg/s", "deg_per_s": "deg/s", "deg_per_sec": "deg/s",
    "rev_s": "rev/s", "rot_s": "rev/s", "turns_s": "rev/s",
    "m_s": "m/s", "mps": "m/s", "m/s": "m/s", "mm_s": "mm/s", "mm/s": "mm/s", "m_s2": "m/s²", "mps2": "m/s²",
    "sec": "s", "secs": "s", "seconds": "s", "ms": "ms", "msec": "ms", "millis": "ms", "us": "us", "usec": "us",
    "micros": "us", "ns": "ns", "nsec": "ns", "nanos": "ns",
    "mm": "mm", "cm": "cm", "meters": "m", "metres": "m",
    "volt": "V", "volts": "V", "mv": "mV", "amp": "A", "amps": "A", "ma": "mA",
    "nm": "N·m", "n_m": "N·m", "n m": "N·m", "mnm": "mN·m", "newtons": "N",
    "celsius": "°C", "degc": "°C", "percent": "percent", "pct": "percent", "g": "g",
}  # fmt: skip
_SPEED = re.compile("vel|speed")  # of which "_ms" is metres per second
_AMBIGUOUS = ("g", "rot")  # a gain or a gravity, a rotation of a vector: only by brackets


def unit_in(name: str) -> str | None:
    """Return the unit that a name says, in brackets or by a last word that can mean nothing else; None where none.

    A word for raw numbers in brackets, such as "counts", is returned as it stands: it has no conversion.
    """
    bracketed = _BRACKETED.search(name)
    if bracketed and not bracketed[1].isdigit():
        word = bracketed[1]
        known = next((form for form in (word, word.lower()) if conversion(form) is not None), None)
        return known or (word.lower() if word.lower() in RAW else None)
    found = _ending(name)
    return found[1] if found else None


def quantity_words(name: str) -> str:
    """Return a name without the unit that it carries."""
    bracketed = _BRACKETED.search(name)
    if (
        bracketed
        and not bracketed[1].isdigit()
        and (conversion(bracketed[1]) is not None or bracketed[1].lower() in RAW)
    ):
        return name[: bracketed.start()]
    found = _ending(name)
    return name if found is None else found[0]


def _ending(name: str) -> tuple[str, str] | None:
    """Return a name without its last word, and the unit that this word means; None where it means none."""
    for form in (name.strip(), _parted(name)):
        for ending, unit in _LONGEST:
            if found := re.search(rf"(?:^|[_\-. /]){re.escape(ending)}$", form.lower()):
                rest = form[: found.start()]
                return rest, "m/s" if unit == "ms" and _SPEED.search(rest.lower()) else unit
    return None


def _parted(name: str) -> str:
    """Return a name with its words apart: "VelocityRadPerSec" is Velocity_Rad_Per_Sec."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name.strip())


_LONGEST = sorted(
    ((ending, unit) for ending, unit in _ENDINGS.items() if ending not in _AMBIGUOUS),
    key=lambda pair: -len(pair[0]),
)
