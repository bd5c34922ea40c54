"""A joint in a log of no known layout: its position, velocity and what drives it."""

from dataclasses import dataclass, field

import numpy as np

from simgap.logs.guessing.behaviour import by_behaviour
from simgap.logs.guessing.inputs import Driven, advice_for_input, inputs_of
from simgap.logs.guessing.motion import Slope, is_still, range_of, slope_of, turns, wrap_of
from simgap.logs.guessing.parts import Named, Part, choices, named_signals, parts_of
from simgap.logs.guessing.unit_fit import SEEN, Fitted, fit_units, unit_alone
from simgap.logs.guessing.words import Said, allows
from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import SURE, Proposal, Proposed, lacking
from simgap.recordings.contract import REQUIRED
from simgap.recordings.units import conversion

_NOTATION = frozenset(("q", "qd", "dq", "qdot", "tau", "theta", "omega"))
_FOUND = 0.97  # correlation from which on another signal is taken for the derivative
_COMPARED = 12  # velocities that are compared with each position
_LISTED = 6  # joints that are named in a note
_RIVAL = 0.85  # factor where a second signal fits a name as well
_ADVICE = {
    "position": "log the encoder's position",
    "velocity": "log the velocity of the joint",
}


@dataclass(frozen=True)
class _Motion:
    """The motion of one part of a machine."""

    part: Part
    position: Named | None
    velocity: Named | None
    units: Fitted
    swing: float
    still: bool
    driven: Driven
    rivals: tuple[str, ...] = field(default=())

    @property
    def filled(self) -> int:
        return (self.position is not None) + (self.velocity is not None) + bool(self.driven.columns)

    @property
    def clarity(self) -> float:
        """How clearly a name says that it is the position or, where there is none, the velocity."""
        leading = self.position or self.velocity
        return leading.said.score if leading else 0.0


def propose_joint(log: Log, said: dict[str, Said]) -> Proposal | None:
    """Propose the columns of the joint that moves most; None where no name says a position or a velocity.

    Args:
        log: with times in s.
        said: what the names of its signals say, without those of the clock.
    """
    said = by_behaviour(log, said)
    named = [each for each in named_signals(said) if allows(each.said.quantity, log.signals[each.name].unit)]
    motions = [_motion(log, named, part) for part in parts_of(named)]
    if not motions:
        return None
    best = max(motions, key=lambda motion: (motion.filled, not motion.still, motion.clarity, motion.swing))
    columns = _columns(log, best) | best.driven.columns
    lost = lacking("joint", set(columns))
    missing = {name: _ADVICE.get(name) or advice_for_input(log, best.driven) for name in lost}
    refusal = _refusal(log, motions)
    return Proposal("joint", _kept(columns), missing, notes=_notes(log, motions, best), refusal=refusal)


def _motion(log: Log, named: list[Named], part: Part) -> _Motion:
    positions = choices(named, "position", False, part)
    velocities = choices(named, "velocity", False, part)
    position, velocity = (found[0] if found else None for found in (positions, velocities))
    pair = [log.signals[each.name] if each else None for each in (position, velocity)]
    slope = slope_of(pair[0], pair[1]) if pair[0] and pair[1] else None
    if pair[0] and (slope is None or abs(slope.correlation) < SEEN):
        velocity, slope = _by_derivative(log, named, pair[0], velocity) or (velocity, slope)
        pair[1] = log.signals[velocity.name] if velocity else None
    leading = pair[0] or pair[1]
    swing = range_of(leading) if leading else 0.0
    notation = [bool(_NOTATION & set(each.said.words)) for each in (position, velocity) if each]
    units = _units(pair[0], pair[1], slope, bool(notation) and all(notation), swing)
    factor = (conversion(units.position) or ("", 1.0, 0.0))[1]
    still = is_still(pair[0], factor) if pair[0] else not (pair[1] and turns(pair[1]))
    rivals = tuple(each.name for found in (positions, velocities) for each in found[1:2])
    driven = inputs_of(log, named, part, units.position, pair[0])
    return _Motion(part, position, velocity, units, swing * abs(factor), still, driven, rivals)


def _units(
    position: Signal | None, velocity: Signal | None, slope: Slope | None, is_si: bool, swing: float
) -> Fitted:
    if position is not None and velocity is not None:
        return fit_units(_unit(position), _unit(velocity), slope, is_si, swing)
    if position is not None:
        unit, sure, why = unit_alone(_unit(position), "rad")
        return Fitted(unit, "rad/s", 1, sure, why)
    unit, sure, why = unit_alone(_unit(velocity), "rad/s")
    return Fitted("rad", unit, 1, sure, why)


def _by_derivative(
    log: Log, named: list[Named], position: Signal, found: Named | None
) -> tuple[Named, Slope] | None:
    """Return another velocity whose integral the position follows, and the slope; None where there is none."""
    best: tuple[Named, Slope] | None = None
    others = [each for each in named if each.said.quantity == "velocity" and each is not found]
    for each in others if len(others) <= _COMPARED else ():
        slope = slope_of(position, log.signals[each.name])
        if slope is not None and slope.correlation > max(_FOUND, best[1].correlation if best else 0.0):
            best = (each, slope)
    return best


def _unit(signal: Signal | None) -> str | None:
    found = conversion(signal.unit) if signal is not None and signal.unit else None
    return signal.unit if signal is not None and found and found[0] != "1" else None


def _columns(log: Log, motion: _Motion) -> dict[str, Proposed]:
    units, columns = motion.units, {}
    rivalry = _RIVAL if motion.rivals else 1.0
    if motion.position:
        score = motion.position.said.score if units.sure < SURE else 1.0
        sure = units.sure * score * (rivalry if units.sure < 0.95 else 1.0)
        columns["position"] = Proposed(
            Source(motion.position.name, units.position),
            round(sure, 2),
            _reason(log, motion, motion.position),
        )
    if motion.velocity:
        score = motion.velocity.said.score if units.sure < SURE else 1.0
        sure = units.sure * score * (rivalry if units.sure < 0.95 else 1.0)
        source = Source(motion.velocity.name, units.velocity, sign=units.sign)
        columns["velocity"] = Proposed(source, round(sure, 2), _reason(log, motion, motion.velocity))
        if not motion.position:
            whole = Source(motion.velocity.name, units.velocity, integrate=True)
            why = "no position is there: the integral of the velocity, right for a wheel, not for an arm"
            columns["position"] = Proposed(whole, 0.6, why)
    return columns


def _reason(log: Log, motion: _Motion, named: Named) -> str:
    width = wrap_of(log.signals[named.name])
    return motion.units.reason + (f"; it wraps at {width:.6g}" if width else "")


def _kept(columns: dict[str, Proposed]) -> dict[str, Proposed]:
    """Leave out what is not sure and not needed."""
    needed = {*REQUIRED["joint"], "velocity"}
    inputs = [name for name in ("effort", "voltage", "position_command") if name in columns]
    if inputs:
        needed.add(max(inputs, key=lambda name: columns[name].confidence))
    return {name: found for name, found in columns.items() if name in needed or found.confidence >= SURE}


def _refusal(log: Log, motions: list[_Motion]) -> str:
    if not all(motion.still for motion in motions):
        return ""
    largest = max(motions, key=lambda motion: motion.swing)
    name = next(each.name for each in (largest.position, largest.velocity) if each)
    values = log.signals[name].values
    spread = float(np.ptp(values[np.isfinite(values)])) if np.isfinite(values).any() else 0.0
    unit = log.signals[name].unit or "of its unit"
    return f"nothing moves: {name!r} stays within {spread:.2g} {unit}; record while the motor is driven"


def _notes(log: Log, motions: list[_Motion], best: _Motion) -> tuple[str, ...]:
    notes = list(best.driven.notes)
    moving = sorted((m for m in motions if not m.still and m.position), key=lambda m: -m.swing)
    if len(moving) > 1:
        listed = ", ".join(
            f"{m.position.name} {m.swing:.3g} {_base(m)}" for m in moving[:_LISTED] if m.position
        )
        notes.append(
            f"{len(moving)} joints move: {listed}. The first of them is proposed; for another one, name its "
            "signals in the mapping file."
            if best is moving[0]
            else f"{len(moving)} joints move: {listed}. For another one, name its signals in the mapping file."
        )
    return tuple(notes)


def _base(motion: _Motion) -> str:
    return (conversion(motion.units.position) or ("rad", 1.0, 0.0))[0]
