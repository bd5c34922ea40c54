"""The catalogue as a person reads it on a terminal: all effects of a kind, or all of one effect."""

import inspect
import textwrap
from collections.abc import Sequence

from simgap.effects.effect import Effect, Parameter

WIDTH = 120
_MOST_PARAMETERS = 4  # of an effect in a listing; of more, the first ones stand for all


def listing(kind: str, effects: Sequence[Effect]) -> str:
    """Return a table of a kind's effects: name, place, parameters, and below them what each is."""
    rows = [(e.key, e.acts_on, ", ".join(shown_parameters(e))) for e in effects]
    wide, narrow = (max(len(row[column]) for row in rows) for column in (0, 1))
    lines = [f"{kind}: {len(rows)} effects"]
    for effect, (key, place, parameters) in zip(effects, rows, strict=True):
        lines += ["", f"  {key:{wide}}  {place:{narrow}}  {parameters}", f"  {'':{wide}}  {meaning(effect)}"]
    return "\n".join(lines) + "\n"


def description(effect: Effect) -> str:
    """Return everything about an effect: what it is, its numbers, what it needs, where it comes from."""
    numbers = [("parameter", parameter_text(parameter)) for parameter in effect.parameters]
    entries = [("acts on", effect.acts_on), *numbers, *((name.lower(), text) for name, text in facts(effect))]
    width = max(len(name) for name, _ in entries)
    lines = [f"{effect.kind} {effect.key}", *textwrap.wrap(meaning(effect), WIDTH), ""]
    for name, text in entries:
        lines += textwrap.wrap(
            text, WIDTH, initial_indent=f"  {name:{width}}  ", subsequent_indent=" " * (width + 4)
        )
    return "\n".join(lines) + "\n"


def meaning(effect: Effect) -> str:
    """Return what an effect is, in one sentence."""
    return (inspect.getdoc(type(effect)) or "").partition("\n")[0]


def shown_parameters(effect: Effect) -> list[str]:
    """Return the parameters of an effect with their units; where there are many, the first ones and how many."""
    every = [f"{parameter.name} ({parameter.unit})" for parameter in effect.parameters]
    return every if len(every) <= _MOST_PARAMETERS else [*every[:2], f"… {len(every)} in all"]


def parameter_text(parameter: Parameter) -> str:
    """Return a parameter with its default, its bounds and the value at which the effect does nothing."""
    return (
        f"{parameter.name} = {parameter.default:g} {parameter.unit} by default, {parameter.low:g} to "
        f"{parameter.high:g}; {parameter.neutral:g} does nothing"
    )


def facts(effect: Effect) -> list[tuple[str, str]]:
    """Return what else there is to say about an effect, with a heading each."""
    stated = f"{effect.statement(effect.defaults())} (with the defaults)"
    if not effect.names_physics:
        stated = "It is never named, since it would take the place of plainer effects; a simulator may be given it."
    elif effect.yields_to:
        stated += f" Where nothing tells them apart, {', '.join(effect.yields_to)} is named instead."
    return [
        ("Formula", effect.formula),
        ("Needs", ", ".join(effect.needs) or "no signal that a recording may lack"),
        ("Diagnosis", stated),
        ("Excitation", effect.excitation),
        ("Source", effect.source),
    ]
