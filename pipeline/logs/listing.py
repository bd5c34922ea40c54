"""What a log holds, as lines that a person reads."""

from collections.abc import Iterator, Sequence

import numpy as np

from simgap.logs.common_times import step_of
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import SURE, Proposal, grouped, lacking

_SHOWN = 40  # signals that are listed unless all are asked for: a screen
_FACTS = 8  # facts that are listed likewise
_GAP = 10.0  # times the usual step, from which on a gap is counted
_NAME = 48  # characters of a name that fit beside the figures


def log_lines(log: Log, proposal: Proposal, every: bool = False) -> Iterator[str]:
    """Yield what is in a log, and what was made of it.

    Args:
        log: as it was read.
        proposal: of it.
        every: whether to list all signals.
    """
    used = dict.fromkeys(entry.source.signal for entry in proposal.columns.values())
    yield from signal_lines(log, list(used), every)
    yield from _run_lines(log, proposal)
    if not proposal.refusal:  # nothing that is missing would mend it
        yield from ["", *_column_lines(proposal)]
    remarks = [*log.remarks, *proposal.notes]
    yield from (["", *remarks] if remarks else [])


def signal_lines(log: Log, used: Sequence[str], every: bool = False) -> Iterator[str]:
    """Yield what a log says of itself, and its signals: those that never change come last.

    Args:
        log: as it was read.
        used: names of the signals that come first.
        every: whether to list all signals.
    """
    yield f"{log.path}: {log.format}, {len(log.signals)} signals"
    facts = [f"{name}: {value}" for name, value in log.facts.items()]
    yield from facts if every else facts[:_FACTS]
    if not every and len(facts) > _FACTS:
        yield f"and {len(facts) - _FACTS} more facts: --all lists them"
    yield ""
    first = [name for name in used if name in log.signals]
    others = sorted(
        (name for name in log.signals if name not in used), key=lambda n: _is_constant(log.signals[n])
    )
    names = [*first, *others]
    shown = names if every else names[:_SHOWN]
    wide = min(max([len(name) for name in shown], default=6), _NAME)
    clock = "row" if log.tabular else "Hz"
    yield f"{'signal':{wide}}  {'samples':>8}  {clock:>7}  {'unit':>7}  {'from':>10}  {'to':>10}  gaps"
    yield from (_signal_line(log.signals[name], wide, log.tabular) for name in shown)
    yield from (f"{name} holds text" for name in log.texts)
    if len(names) > len(shown):
        yield f"and {len(names) - len(shown)} more: --all lists them"


def _is_constant(signal: Signal) -> bool:
    known = signal.values[np.isfinite(signal.values)]
    return len(known) == 0 or bool((known == known[0]).all())


def _signal_line(signal: Signal, wide: int, tabular: bool) -> str:
    known = signal.values[np.isfinite(signal.values)]
    low, high = (f"{known.min():.5g}", f"{known.max():.5g}") if len(known) else ("-", "-")
    step = step_of(signal.time)
    rate = "" if tabular or not np.isfinite(step) or step <= 0 else f"{1 / step:.4g}"
    gaps = int((np.diff(signal.time) > _GAP * step).sum()) if np.isfinite(step) and not tabular else 0
    name = signal.name if len(signal.name) <= wide else f"…{signal.name[1 - wide :]}"
    return f"{name:{wide}}  {len(known):8d}  {rate:>7}  {signal.unit or '':>7}  {low:>10}  {high:>10}  {gaps or ''}"


def _run_lines(log: Log, proposal: Proposal) -> Iterator[str]:
    spans = proposal.windows or log.spans
    if spans:
        yield ""
        yield f"{len(spans)} run{'s' if len(spans) > 1 else ''}:"
        yield from (f"  {span.name}: {span.begin:.2f} to {span.end:.2f} s" for span in spans[:_SHOWN])
        if len(spans) > _SHOWN:
            yield f"  and {len(spans) - _SHOWN} more"


def _source_text(source: Source) -> str:
    """Return a signal with what is done to it, and the unit of that: "motor_deg · -1, in deg"."""
    factors = [f"{each:.4g}" for each in (source.sign * source.scale,) if each != 1.0]
    factors += [each for each in (source.times, source.ratio) if each]
    value = " · ".join([source.signal, *factors])
    value += f" {'-' if source.offset < 0 else '+'} {abs(source.offset):.4g}" if source.offset else ""
    value = f"the square root of {value}" if source.root else value
    value = f"the integral of {value}" if source.integrate else value
    words = [f"in {source.unit}"] if source.unit and source.unit != "1" else []
    words += ["held" if source.held else "not held"] if source.held is not None else []
    words += [f"{source.missing:g} is missing"] if source.missing is not None else []
    return ", ".join([value, *words])


def _column_lines(proposal: Proposal) -> Iterator[str]:
    if proposal.kind is None:
        yield "No kind of machine fits: give --kind quadrotor, swerve or joint, or write a mapping."
        return
    yield f"as a {proposal.kind}:"
    for column, entry in proposal.columns.items():
        doubt = "" if entry.confidence >= SURE else "  please check"
        yield f"  {column:20} {_source_text(entry.source)}  {entry.confidence:.2f}: {entry.reason}{doubt}"
    lost = lacking(proposal.kind, set(proposal.columns))
    alike: dict[tuple[bool, str], list[str]] = {}
    for column in dict.fromkeys([*lost, *proposal.missing]):
        advice = proposal.missing.get(column, "") or "no signal looks like it"
        advice = f"{advice[0].upper()}{advice[1:].rstrip('.')}."
        alike.setdefault((column in lost, advice), []).append(column)
    for (needed, advice), columns in alike.items():
        named = grouped(columns).replace("'", "")
        yield f"  {named:20} missing ({'needed' if needed else 'better with it'}). {advice}"
