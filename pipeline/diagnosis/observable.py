"""What a recording shows nothing of: known effects of a simulator whose signals were not recorded."""

from simgap.gap.candidates import available_signals
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.signals import recorded_signals


def observable(recording: Recording, nominal: Simulator) -> tuple[Simulator, tuple[FittedEffect, ...]]:
    """Return a simulator without the effects that a recording cannot drive, and those effects.

    A drag that is known already cannot act on a flight whose speed is not known.

    Args:
        recording: cleaned.
        nominal: what is believed before.
    """
    known = available_signals(recorded_signals(recording.frame, nominal.platform))
    aside = tuple(fitted for fitted in nominal.effects if not set(fitted.effect.needs) <= known)
    if not aside:
        return nominal, ()
    return nominal.with_effects(tuple(f for f in nominal.effects if f not in aside)), aside


def unjudged(aside: tuple[FittedEffect, ...]) -> list[str]:
    """Return a sentence about known effects that were left out of the comparison."""
    if not aside:
        return []
    names = ", ".join(fitted.effect.name for fitted in aside)
    return [f"{names}: known before, but what it depends on was not recorded; left out of the comparison"]
