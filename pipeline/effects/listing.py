"""Text of the catalogue for the terminal: the effects of a kind, or all facts about one effect."""

import inspect
import textwrap
from collections.abc import Sequence

from simgap.effects.catalogue import look_alikes_of
from simgap.effects.effect import Effect, Parameter

WIDTH = 120
_MOST_PARAMETERS = 4  # of an effect in a listing; a longer list is cut to its first entries


def listing(kind: str, effects: Sequence[Effect]) -> str:
    """Return a table of a kind's effects: name, place, parameters and, on a second line, the meaning."""
    rows = [(e.key, e.acts_on, ", ".join(shown_parameters(e))) for e in effects]
    wide, narrow = (max(len(row[column]) for row in rows) for column in (0, 1))
    lines = [_counted(kind, effects)]
    for effect, (key, place, parameters) in zip(effects, rows, strict=True):
        lines += ["", f"  {key:{wide}}  {place:{narrow}}  {parameters}", f"  {'':{wide}}  {meaning(effect)}"]
    return "\n".join(lines) + "\n"


def _counted(kind: str, effects: Sequence[Effect]) -> str:
    """Say how many effects a diagnosis names, and why more lines may follow."""
    named = {effect.name for effect in effects if effect.names_physics}
    silent = sum(not effect.names_physics for effect in effects)
    more = [f"{silent} more only in a simulator"] if silent else []
    apart = ["one line for each rotor or group"] if len({e.name for e in effects}) < len(effects) else []
    ending = f"; {', '.join([*more, *apart])}" if more or apart else ""
    return f"{kind}: a diagnosis names {len(named)} effects{ending}"


def description(effect: Effect) -> str:
    """Return all facts about an effect: meaning, parameters, law, symptom, manoeuvre, look-alikes and source."""
    numbers = [("parameter", parameter_text(effect, parameter)) for parameter in effect.parameters]
    entries = [("acts on", effect.acts_on), *numbers, *((name.lower(), text) for name, text in facts(effect))]
    width = max(len(name) for name, _ in entries)
    lines = [f"{effect.kind} {effect.key}", *textwrap.wrap(meaning(effect), WIDTH), ""]
    for name, text in entries:
        lines += textwrap.wrap(
            text, WIDTH, initial_indent=f"  {name:{width}}  ", subsequent_indent=" " * (width + 4)
        )
    return "\n".join(lines) + "\n"


def meaning(effect: Effect) -> str:
    """Return the meaning of an effect in one sentence."""
    return (inspect.getdoc(type(effect)) or "").partition("\n")[0]


def shown_parameters(effect: Effect) -> list[str]:
    """Return the parameters of an effect with their units; of a long list, the first ones and the count."""
    every = [f"{parameter.name} ({parameter.unit})" for parameter in effect.parameters]
    return every if len(every) <= _MOST_PARAMETERS else [*every[:2], f"… {len(every)} in all"]


def parameter_text(effect: Effect, parameter: Parameter) -> str:
    """Return a parameter with its default and its bounds, and its neutral value where that alone stops the effect."""
    bounds = f"{parameter.low:g} to {parameter.high:g}"
    text = f"{parameter.name} = {parameter.default:g} {parameter.unit} by default, {bounds}"
    stops = parameter.neutral == 0.0 or len(effect.parameters) == 1
    return f"{text}; no effect at {parameter.neutral:g}" if stops else text


def facts(effect: Effect) -> list[tuple[str, str]]:
    """Return the facts about an effect besides meaning and parameters, each with its heading."""
    return [
        ("Law", effect.formula),
        ("In a log", effect.symptom),
        ("Manoeuvre", f"{effect.excitation[0].upper()}{effect.excitation[1:]}."),
        ("Look-alikes", ", ".join(other.key for other in look_alikes_of(effect)) or "none in this catalogue"),
        ("Needs", ", ".join(effect.needs) or "only signals that every recording has"),
        ("Diagnosis", _stated(effect)),
        ("Source", effect.source),
    ]


def _stated(effect: Effect) -> str:
    """Return what a diagnosis says about an effect of the default size."""
    if not effect.names_physics:
        return "A diagnosis never names this effect, because it would absorb simpler ones. A simulator may contain it."
    return effect.statement(effect.defaults())
