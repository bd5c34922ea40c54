"""A mapping proposed by names, units and what the signals say, for logs of no known layout."""

from dataclasses import replace

from simgap.errors import InputError
from simgap.logs.guessing.clock import Clock, clock_of
from simgap.logs.guessing.joint import propose_joint
from simgap.logs.guessing.words import Said, said_by, words_of
from simgap.logs.log import Log
from simgap.logs.mapping import Mapping
from simgap.logs.proposal import Proposal, lacking
from simgap.logs.table_clock import with_clock

_NOTHING = "no signal is known by its name or behaviour as one of a joint, quadrotor or swerve drive"
_NOT_OF_KIND = "no signal is known by its name or behaviour as one of a {}"
_OTHER_KIND = (
    "looks like the log of a {}, not of a {}: give the platform of the machine that was logged, or a mapping"
)
_RATE_WORDS = frozenset(("hz", "rate", "fs", "frequency", "fps"))
_TIME_ADVICE = (
    "log a time with every sample, or give rate: HERTZ in the mapping where all samples are equally far apart"
)


def guess(log: Log, kind: str | None) -> Proposal:
    """Propose a mapping of a log of no known layout; see `simgap.logs.proposal.propose`."""
    if not any(len(signal.time) for signal in log.signals.values()):
        return Proposal(kind, {}, refusal="holds no numbers: record it again, or give another file")
    clock = clock_of(log) if log.tabular else Clock(None, None)
    timed = _timed(log, clock)
    used = {found.source.signal for found in (clock.time, clock.run) if found is not None}
    said = {name: said_by(name) for name in timed.signals if name not in used}
    found = _of_kind(timed, said, kind)
    if kind is not None and (found is None or lacking(kind, set(found.columns))):
        other = _of_kind(timed, said, None)
        if other is not None and other.kind != kind and not lacking(str(other.kind), set(other.columns)):
            return Proposal(kind, {}, refusal=_OTHER_KIND.format(other.kind, kind))
    if found is None:
        return Proposal(kind, {}, refusal=_NOTHING if kind is None else _NOT_OF_KIND.format(kind))
    return _with_clock(found, log, clock)


def _of_kind(log: Log, said: dict[str, Said], kind: str | None) -> Proposal | None:
    """Return the proposal of a kind; where none is given, the first kind of which all is there, else a joint."""
    from simgap.logs.guessing.quadrotor import propose_quadrotor
    from simgap.logs.guessing.swerve import propose_swerve

    makers = {"quadrotor": propose_quadrotor, "swerve": propose_swerve, "joint": propose_joint}
    if kind is not None:
        return makers[kind](log, said)
    partly = None
    for name in ("quadrotor", "swerve"):
        found = makers[name](log, said)
        if found is not None and not lacking(name, set(found.columns)):
            return found
        partly = partly or found
    return partly or propose_joint(log, said)


def _timed(log: Log, clock: Clock) -> Log:
    """Return the log with times in s; with row numbers where no column is the time."""
    if not log.tabular:
        return log
    columns = {
        name: found.source
        for name, found in (("t", clock.time), ("run", clock.run))
        if found is not None and (name == "t" or clock.time is not None)
    }
    rate = None if clock.time else 1.0
    try:
        return with_clock(log, Mapping("joint", columns, rate=rate))[0]
    except InputError:
        return with_clock(log, Mapping("joint", {}, rate=1.0))[0]


def _time_advice(log: Log) -> str:
    """Return how to give the time; with the rate, if the file says one."""
    for name, value in log.facts.items():
        if set(words_of(name)) & _RATE_WORDS:
            return f"the file says {name} = {value}: if that is the rate of the samples in Hz, give rate: {value}"
    return _TIME_ADVICE


def _with_clock(found: Proposal, log: Log, clock: Clock) -> Proposal:
    if not log.tabular:
        return found
    columns = {
        name: proposed for name, proposed in (("t", clock.time), ("run", clock.run)) if proposed is not None
    }
    missing = dict(found.missing) if clock.time else {"t": _time_advice(log)} | dict(found.missing)
    from simgap.logs.sparse import held_inputs

    names = {name: each.source.signal for name, each in found.columns.items()}
    held = held_inputs(log, names, found.kind or "joint")
    kept = {
        name: replace(each, source=replace(each.source, held=True)) if name in held else each
        for name, each in found.columns.items()
    }
    return replace(found, columns=columns | kept, missing=missing)
