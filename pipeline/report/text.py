"""How numbers, units and names are written for people."""

import math
import re
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import TypeGuard

from markupsafe import Markup, escape

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
UNKNOWN = "unknown"
Real = float | int
"""A number as JSON gives it."""
NARROW_SPACE, NO_BREAK = "\u202f", "\u00a0"
_HYPHEN_MINUS = re.compile(r"(?<![\w)\]-])-(?=[\d.])")
_EXPONENT = re.compile(r"(?<!\w)(\d+(?:\.\d+)?)e([+-]\d+)\b")
_CAPITAL = re.compile(r"\b(coulomb|stribeck)\b")  # people


def is_number(value: object) -> TypeGuard[Real]:
    """Whether a value read from JSON is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def number(value: Real | None, digits: int = 3) -> str:
    """Write a number with so many significant digits; very large and very small ones as a power of ten."""
    if value is None or not is_number(value):
        return UNKNOWN
    if value == 0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if -3 <= exponent < 5:
        return _minus(f"{value:.{max(digits - 1 - exponent, 0)}f}")
    return f"{_minus(f'{value / 10.0**exponent:.{digits - 1}f}')}×{_power(exponent)}"


def short(value: Real | None, digits: int = 3) -> str:
    """Write a number with up to so many significant digits and no trailing zeros."""
    text = number(value, digits)
    mantissa, cross, power = text.partition("×")
    return (mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa) + cross + power


def apart(values: Sequence[Real], digits: int = 2, most: int = 6) -> list[str]:
    """Write numbers with as many digits as it takes to tell neighbours apart, if `most` are enough."""
    for more in range(digits, most):
        written = [short(value, more) for value in values]
        if all(
            one != other or a == b
            for (one, other), (a, b) in zip(pairwise(written), pairwise(values), strict=True)
        ):
            return written
    return [short(value, most) for value in values]


def estimate(value: Real | None, std: Real | None, unit: str = "") -> str:
    """Write `value ± standard error unit`, rounded to two digits of the standard error."""
    if value is None or not is_number(value) or std is None or not is_number(std) or std <= 0:
        return with_unit(number(value, 4), unit)
    exponent = math.floor(math.log10(max(abs(value), std)))
    scale = 10.0**exponent if not -3 <= exponent < 5 else 1.0
    places = min(max(1 - math.floor(math.log10(std / scale)), 0), 12)
    pair = f"{_minus(f'{value / scale:.{places}f}')}{NO_BREAK}±{NO_BREAK}{std / scale:.{places}f}"
    return with_unit(pair if scale == 1.0 else f"({pair})×{_power(exponent)}", unit)


def with_unit(text: str, unit: str | None) -> str:
    """Append a unit, if there is one."""
    return f"{text} {pretty_unit(unit)}".strip()


def pretty_unit(unit: str | None) -> str:
    """Write `m/s^2` as m/s², `1/s` as s⁻¹, and the dimensionless `1` as nothing."""
    text = (unit or "").strip()
    if text == "1":
        return ""
    if reciprocal := re.fullmatch(r"1/([A-Za-zΩ]+)\^?(\d?)", text):
        return f"{reciprocal[1]}{('-' + (reciprocal[2] or '1')).translate(_SUPERSCRIPTS)}"
    raised = re.sub(r"(?:\^|\*\*)(-?\d+)", lambda match: match[1].translate(_SUPERSCRIPTS), text)
    return raised.replace("*", "·")


def quantity(name: str, unit: str | None) -> str:
    """Write the name of a quantity with its unit in brackets, as on an axis."""
    return f"{spoken(name)} ({pretty_unit(unit)})" if pretty_unit(unit) else spoken(name)


def percent(share: Real | None) -> str:
    """Write a share as a percentage; what is not quite all of it is never rounded up to that."""
    if share is None or not is_number(share):
        return UNKNOWN
    if 0.995 <= share < 1.0:
        return f"{math.floor(1000.0 * share) / 10.0:.1f}{NARROW_SPACE}%"
    digits = 1 if 0 < abs(share) < 0.0995 else 0
    return f"{_minus(f'{100 * share:.{digits}f}')}{NARROW_SPACE}%"


def probability(value: Real | None) -> str:
    """Write a probability as a percentage that never claims certainty."""
    if value is None or not is_number(value):
        return UNKNOWN
    if value > 0.99:
        return f">{NARROW_SPACE}99{NARROW_SPACE}%"
    return f"<{NARROW_SPACE}1{NARROW_SPACE}%" if value < 0.01 else percent(round(value, 2))


def p_value(value: Real | None) -> str:
    """Write a p-value; what is below the resolution of any test is given as a bound."""
    if value is None or not is_number(value):
        return UNKNOWN
    if value < 1e-15:
        return f"<{NARROW_SPACE}10⁻¹⁵"
    return number(value, 2) if value >= 1e-3 else number(value, 1)


def interval(bounds: Sequence[Real | None] | None) -> str:
    """Write an interval of shares, `95 % to 98 %`, or nothing where there is none."""
    if not bounds or len(bounds) != 2 or not all(map(is_number, bounds)):
        return ""
    return f"{percent(bounds[0])} to {percent(bounds[1])}"


def spoken(name: object) -> str:
    """Write a programmer's name as words: `rotor_drag` as rotor drag."""
    return _CAPITAL.sub(lambda match: match[0].capitalize(), str(name).replace("_", " "))


def sentence(text: str) -> str:
    """Write a sentence of the diagnosis as print does: names as words, spaced per cent, one minus sign."""
    words = re.sub(r"\b[a-z]+(?:_[a-z]+)+\b|\b(coulomb|stribeck)\b", lambda name: spoken(name[0]), text)
    return minus(re.sub(r"(?<=\d)%", f"{NARROW_SPACE}%", words))


def listed(items: Iterable[object], last: str = "and") -> str:
    """Write items as a sentence does: a, b and c."""
    words = [str(item) for item in items]
    return f" {last} ".join([", ".join(words[:-1]), words[-1]] if len(words) > 1 else words)


def minus(text: str) -> str:
    """Write every minus sign before a number as U+2212, and `1e-05` as a power of ten; names keep their hyphens."""
    powers = _EXPONENT.sub(lambda match: f"{match[1]}×{_power(int(match[2]))}", text)
    return _HYPHEN_MINUS.sub("−", powers)


def breakable(name: object) -> Markup:
    """Write a name so that it breaks after its underscores and nowhere inside a word."""
    return Markup(str(escape(minus(str(name)))).replace("_", "_<wbr>"))


def _minus(text: str) -> str:
    return text.replace("-", "−")


def _power(exponent: int) -> str:
    return "10" + str(exponent).translate(_SUPERSCRIPTS)
