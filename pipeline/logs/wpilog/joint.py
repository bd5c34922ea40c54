"""Columns of a single axis in a robot's log: voltage, position and velocity of one motor, or of several by SysId."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposal, Proposed
from simgap.logs.wpilog.advice import HOW, JOINT, NO_DUTY
from simgap.logs.wpilog.checks import moves
from simgap.logs.wpilog.motors import JOINED, QUANTITIES, Motor, motor_spans, sysid_motors
from simgap.logs.wpilog.spans import TESTS
from simgap.logs.wpilog.swerve import battery_of, duty_of
from simgap.logs.wpilog.words import words_of
from simgap.recordings.units import conversion

_NAMED, _CHOSEN, _UNSURE = 0.95, 0.6, 0.5
_BY_SYSID = 1.0
_UNITS: dict[str, tuple[str, ...]] = {
    "voltage": ("V",),
    "position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "current": ("A",),
}


def propose_joint(log: Log) -> Proposal:
    """Propose the columns of one axis; see `simgap.logs.proposal.propose`."""
    motors = sysid_motors(list(log.signals), [*log.signals, *log.facts])
    if motors:
        return _by_sysid(log, motors)
    axes = _axes(log.signals)
    if not axes:
        return _nothing(log)
    best = max(axes, key=lambda name: _activity(axes[name], log))
    sure = _NAMED if len(axes) == 1 else _CHOSEN
    reason = (
        "the one axis of the log" if len(axes) == 1 else f"one of {len(axes)} axes, the one that moves most"
    )
    columns = {quantity: _column(signal, quantity, sure, reason) for quantity, signal in axes[best].items()}
    others = sorted(_shown(name) for name in axes if name != best)
    notes = (f"Other axes of this log: {', '.join(others[:8])}.",) if others else ()
    return _proposal(log, columns, notes=notes)


def _by_sysid(log: Log, motors: list[Motor]) -> Proposal:
    together = all(JOINED + quantity in log.signals for quantity in QUANTITIES)
    names = (
        {quantity: JOINED + quantity for quantity in (*QUANTITIES, "current")}
        if together
        else motors[0].signals
    )
    columns = {
        quantity: _column(log.signals[name], quantity, _BY_SYSID, "logged by a SysId routine")
        for quantity, name in names.items()
        if name in log.signals
    }
    windows = motor_spans(motors, log.signals, log.spans) if together else ()
    notes = []
    if together:
        notes.append(f"Each test of each motor is a run: {', '.join(motor.name for motor in motors)}.")
    elif len(motors) > 1:
        columns = {
            name: _column(log.signals[e.source.signal], name, _CHOSEN, "one of several motors")
            for name, e in columns.items()
        }
        notes.append(f"Other motors of this log: {', '.join(motor.name for motor in motors[1:])}.")
    lost = [test for test in TESTS if not any(test in span.name for span in log.spans)]
    if lost:
        notes.append(f"Tests that were not run: {', '.join(lost)}.")
    return _proposal(log, columns, windows=windows, notes=tuple(notes))


def _proposal(log: Log, columns: dict[str, Proposed], **more: Any) -> Proposal:
    battery = battery_of(log.signals)
    if battery is not None and not any(entry.source.signal.startswith(JOINED) for entry in columns.values()):
        columns["battery_voltage"] = Proposed(Source(battery.name, "V"), _NAMED, "its name")
    duty = duty_of(log.signals)
    said = f"{NO_DUTY.format(duty)}: " if duty else ""
    missing = {
        name: f"{said if name == 'voltage' else ''}{JOINT[name]}; {HOW}"
        for name in ("position", "velocity", "voltage")
        if name not in columns
    }
    if "voltage" in missing:  # the contract asks for an effort where there is neither
        missing["effort"] = missing.pop("voltage")
    motion = [
        log.signals[columns[name].source.signal] for name in ("position", "velocity") if name in columns
    ]
    refusal = "" if moves(motion) else f"the axis does not move in this log: run a SysIdRoutine; {HOW}"
    return Proposal("joint", columns, missing, refusal=refusal, **more)


def _nothing(log: Log) -> Proposal:
    duty = duty_of(log.signals)
    said = f"; {NO_DUTY.format(duty)}" if duty else ""
    refusal = f"no motor with voltage, position and velocity was logged{said}: {JOINT['voltage']}; {HOW}"
    missing = {name: f"{advice}; {HOW}" for name, advice in JOINT.items()}
    missing["effort"] = missing.pop("voltage")
    return Proposal("joint", {}, missing, refusal=refusal)


def _axes(signals: Mapping[str, Signal]) -> dict[str, dict[str, Signal]]:
    """Return the axes whose voltage, position and velocity have names alike: {stem: {quantity: signal}}."""
    axes: dict[str, dict[str, Signal]] = {}
    for signal in signals.values():
        words = words_of(signal)
        if (
            words.quantity not in _UNITS
            or words.wanted
            or not words.of_motor
            or not _fits(signal, words.quantity)
        ):
            continue
        axis = axes.setdefault(words.stem, {})
        if words.quantity not in axis or not words.absolute:
            axis[words.quantity] = signal
    return {stem: axis for stem, axis in axes.items() if set(QUANTITIES) <= set(axis) and _alike(axis)}


def _fits(signal: Signal, quantity: str) -> bool:
    found = conversion(signal.unit) if signal.unit else None
    return signal.unit is None or (found is not None and found[0] in _UNITS[quantity])


def _alike(axis: Mapping[str, Signal]) -> bool:
    """Return whether position and velocity are both in angles or both in lengths, as far as the log says."""
    units = [conversion(axis[name].unit or "") for name in ("position", "velocity")]
    lengths = [found[0] in ("m", "m/s") for found in units if found is not None and found[0] != "1"]
    return len(set(lengths)) < 2


def _activity(axis: Mapping[str, Signal], log: Log) -> float:
    """Return how much of the log's runs an axis spends in motion under voltage, as a number to compare."""
    voltage, velocity = axis["voltage"], axis["velocity"]
    inside = np.zeros(len(voltage.time), dtype=bool)
    for span in log.spans or ():
        inside |= (voltage.time >= span.begin) & (voltage.time <= span.end)
    values = voltage.values[inside] if log.spans else voltage.values
    moving = len(np.unique(velocity.values[np.isfinite(velocity.values)])) > 1
    return float(np.nansum(np.abs(values)) * moving)


def _column(signal: Signal, quantity: str, confidence: float, reason: str) -> Proposed:
    held = True if quantity == "voltage" else None
    if signal.unit is None and quantity != "voltage":
        return Proposed(
            Source(signal.name, held=held), min(confidence, _UNSURE), f"{reason}; the log says no unit"
        )
    return Proposed(
        Source(signal.name, "V" if quantity == "voltage" else None, held=held), confidence, reason
    )


def _shown(stem: str) -> str:
    return stem.strip("/") or "(unnamed)"
