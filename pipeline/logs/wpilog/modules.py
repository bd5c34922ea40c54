"""Signals of the modules of a swerve drive, found by their names."""

import re
from collections.abc import Mapping

from simgap.logs.log import Signal
from simgap.logs.wpilog.words import Words, words_in, words_of

_NUMBERED = re.compile(
    r"(?i)(?:module|mod|states?|speeds?|positions?|measured|actual)[ _-]?\[?(\d)\]?(?![\d.])"
)
_CORNERS = (
    ({"front", "left"}, {"fl"}, {"lf"}),
    ({"front", "right"}, {"fr"}, {"rf"}),
    ({"back", "left"}, {"rear", "left"}, {"bl"}, {"rl"}, {"lb"}),
    ({"back", "right"}, {"rear", "right"}, {"br"}, {"rr"}, {"rb"}),
)  # the order of WPILib's examples, AdvantageKit, CTRE and YAGSL: front left, front right, back left, back right

Found = dict[tuple[str, str], dict[int, Signal]]
"""(group, quantity) to the signal of each module, 1 to 4."""


def modules_of(signals: Mapping[str, Signal]) -> Found:
    """Return the measured signals of the modules: ("drive", "voltage") to {1: …, 2: …} and so on.

    Of several signals for one thing, the one with a relative encoder and more samples is taken.
    """
    found: dict[tuple[str, str], dict[int, list[tuple[bool, bool, int, Signal]]]] = {}
    zero_based = any(_number(name) == 0 for name in signals)
    for name, signal in signals.items():
        module = module_of(name, zero_based)
        words = words_of(signal)
        if module is None or not _is_measured(words) or not words.group or not words.quantity:
            continue
        rank = (not words.absolute, not name.endswith(("/speed", "/angle/value")), len(signal.time))
        found.setdefault((words.group, words.quantity), {}).setdefault(module, []).append((*rank, signal))
    return {
        key: {module: max(ranked, key=lambda entry: entry[:3])[3] for module, ranked in sorted(own.items())}
        for key, own in found.items()
    }


def module_of(name: str, zero_based: bool) -> int | None:
    """Return the number of the module that a name is about, 1 to 4; None where it is about none."""
    words = set(words_in(name))
    for number, corners in enumerate(_CORNERS, 1):
        if any(corner <= words for corner in corners):
            return number
    counted = _number(name)
    if counted is None or not 1 <= counted + zero_based <= 4:
        return None
    return counted + zero_based


def _number(name: str) -> int | None:
    match = _NUMBERED.search(name)
    return int(match[1]) if match else None


def _is_measured(words: Words) -> bool:
    return words.of_motor and not words.wanted
