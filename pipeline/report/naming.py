"""Names of effects as words, with what they are about: `rotor fault (rotor 3)`, `backlash (steer)`."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from simgap.report.text import listed, spoken


def subject_of(effect: Mapping[str, Any], among: Iterable[Mapping[str, Any]] = ()) -> str:
    """Return what the name of an effect is about, as words; empty where the name says that.

    Args:
        effect: of a diagnosis (docs/contract.md).
        among: the effects of the diagnosis. If it names no subjects, the group tells two entries of one name apart.
    """
    name, subject = str(effect["name"]), effect.get("subject")
    if not subject and [other["name"] for other in among].count(effect["name"]) > 1:
        subject = effect.get("acts_on")
    return _spoken_subject(name, subject)


def with_subject(name: str, subject: str) -> str:
    """Write a name with its subject in brackets, if there is one."""
    return f"{name} ({subject})" if subject else name


def key_in_words(key: str, subjects: Mapping[str, str]) -> str:
    """Write the key of an effect as words: `rotor_fault@3` as rotor fault (rotor 3).

    Args:
        key: a name, in the evidence with `@` and a rotor or a group behind it.
        subjects: what the names of the diagnosis are about, as words; used where a key does not say that.
    """
    name, _, about = str(key).partition("@")
    own = (
        "" if about == "chassis" else _spoken_subject(name, about)
    )  # of all groups, the chassis is no subject
    return with_subject(spoken(name), own or subjects.get(name, ""))


def each_once(effects: Sequence[Mapping[str, Any]]) -> list[str]:
    """Name every effect once, with all its subjects: `viscous friction (drive and steer)`."""
    subjects: dict[str, list[str]] = {}
    for effect in effects:
        about = subjects.setdefault(str(effect["name"]), [])
        about += [subject for subject in [subject_of(effect)] if subject and subject not in about]
    return [with_subject(spoken(name), listed(about)) for name, about in subjects.items()]


def rivals(entry: Mapping[str, Any]) -> list[str]:
    """Return the names of an entry of `ambiguous` as words with their subjects."""
    names = [str(name) for name in entry["names"]]
    subjects = entry.get("subjects") or [None] * len(names)
    pairs = zip(names, subjects, strict=True)
    return [with_subject(spoken(name), _spoken_subject(name, subject)) for name, subject in pairs]


def _spoken_subject(name: str, subject: object) -> str:
    """Write a subject as words; a number counts what the name begins with, such as rotors."""
    text = str(subject or "")
    return f"{name.partition('_')[0]} {text}" if text.isdigit() else spoken(text)
