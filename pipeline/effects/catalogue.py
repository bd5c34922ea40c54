"""Discovery of effects: every public class in the folder of a kind belongs to the catalogue."""

import difflib
import functools
import importlib
import inspect
import pkgutil

from simgap.effects.effect import Effect
from simgap.errors import InputError

_PACKAGE = "simgap.effects"


@functools.cache
def kinds() -> tuple[str, ...]:
    """Return the kinds of platform that have a folder of effects, in alphabetical order."""
    package = importlib.import_module(_PACKAGE)
    return tuple(sorted(entry.name for entry in pkgutil.iter_modules(package.__path__) if entry.ispkg))


@functools.cache
def effects_of(kind: str) -> tuple[Effect, ...]:
    """Return every effect of a platform kind, in alphabetical order of its key."""
    package = importlib.import_module(f"{_PACKAGE}.{kind}")
    effects = []
    for module_info in pkgutil.iter_modules(package.__path__):
        module = importlib.import_module(f"{package.__name__}.{module_info.name}")
        effects += [
            member()
            for member in vars(module).values()
            if inspect.isclass(member)
            and issubclass(member, Effect)
            and member.__module__ == module.__name__
            and not member.__name__.startswith("_")
            and not inspect.isabstract(member)
        ]
    return tuple(sorted(effects, key=lambda effect: effect.key))


def effect_by_key(kind: str, key: str) -> Effect:
    """Return one effect.

    Raises:
        InputError: when the catalogue of that kind has no such effect; the nearest name is suggested.
    """
    known = {effect.key: effect for effect in effects_of(kind)}
    if key not in known:
        near = difflib.get_close_matches(key, known, n=1, cutoff=0.4)
        remedy = f"did you mean {near[0]!r}?" if near else f"known: {', '.join(known)}"
        raise InputError(f"unknown effect {key!r} for a {kind}", "effects", remedy)
    return known[key]


@functools.cache
def look_alikes_of(effect: Effect) -> tuple[Effect, ...]:
    """Return the effects of the same kind that a poor recording cannot separate from this one."""
    if not effect.names_physics:
        return ()
    return tuple(o for o in effects_of(effect.kind) if o.names_physics and _is_like(effect, o))


def _is_like(one: Effect, other: Effect) -> bool:
    """Whether either effect names the other, and both act on one group of a swerve drive or one on its chassis."""
    named = other.name in one.look_alikes or one.name in other.look_alikes
    apart = (
        one.kind == "swerve"
        and one.acts_on != other.acts_on
        and "chassis" not in (one.acts_on, other.acts_on)
    )
    return named and not apart
