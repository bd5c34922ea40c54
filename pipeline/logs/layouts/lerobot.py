"""LeRobot data sets: the joint that moves most, and the target that it was given."""

from collections.abc import Iterator

import numpy as np

from simgap.logs.log import Log
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposal, Proposed
from simgap.recordings.contract import COLUMNS

_STATE, _ACTION = "observation.state", "action"
_STILL = {"deg": 1.0, "rad": 0.017}  # ten steps of a servo of 4096 counts, 0.09 degrees each
_TURN = 6.3  # rad; nothing beyond one turn, in radians
_RANGE = 100.0  # to which LeRobot brings joints that are not in degrees: −100 to 100
_NO_ANGLE = ("gripper", "jaw", "finger")  # opened by 0 to 100 percent
_UNSURE = 0.6


def propose(log: Log, kind: str | None = None) -> Proposal | None:
    """Propose the columns of a data set of LeRobot; None for other logs.

    Args:
        log: as it was read.
        kind: of the platform; another than a joint is refused.
    """
    if log.format != "LeRobot":
        return None
    if kind not in (None, "joint"):
        return Proposal(kind, {}, refusal=f"is a data set of an arm, not of a {kind}")
    motion = dict(_motion(log))
    if not motion:
        return Proposal(
            "joint", {}, refusal=f"holds no {_STATE} of a joint; record the positions of the joints"
        )
    unit, confidence, reason = _unit(log)
    moving = [
        joint for joint in sorted(motion, key=lambda name: -motion[name]) if motion[joint] > _STILL[unit]
    ]
    if not moving:
        largest = max(motion.values())
        return Proposal(
            "joint", {}, refusal=f"no joint moves by more than {largest:.2g} {unit}; record a motion"
        )
    columns = _columns(log, moving[0], unit, confidence, reason)
    return Proposal("joint", columns, _missing(columns), notes=tuple(_notes(log, moving, motion, unit)))


def _motion(log: Log) -> Iterator[tuple[str, float]]:
    """Yield each joint and how far it moves, without grippers."""
    head = f"{_STATE}["
    for name, signal in log.signals.items():
        joint = name[len(head) : -1]
        values = signal.values[np.isfinite(signal.values)]
        if name.startswith(head) and len(values) and not _is_no_angle(joint):
            yield joint, float(np.ptp(values))


def _is_no_angle(joint: str) -> bool:
    return any(part in joint.lower() for part in _NO_ANGLE) or joint.endswith((".vel", ".effort", ".torque"))


def _columns(log: Log, joint: str, unit: str, confidence: float, reason: str) -> dict[str, Proposed]:
    columns = {"position": Proposed(Source(f"{_STATE}[{joint}]", unit=unit), confidence, reason)}
    target = f"{_ACTION}[{joint}]"
    if "position_command" in COLUMNS["joint"] and target in log.signals:
        columns["position_command"] = Proposed(
            Source(target, unit=unit, held=True), confidence, f"the target; {reason}"
        )
    return columns


def _unit(log: Log) -> tuple[str, float, str]:
    """Return the unit of the joints, how sure it is, and why; a data set does not say it."""
    largest = max(
        float(np.nanmax(np.abs(signal.values), initial=0.0))
        for name, signal in log.signals.items()
        if name.startswith((f"{_STATE}[", f"{_ACTION}[")) and not _is_no_angle(name.partition("[")[2][:-1])
    )
    if largest > _RANGE:
        return "deg", 0.95, "degrees, since joints go beyond the 100 percent that LeRobot otherwise writes"
    if largest < _TURN:
        return "rad", _UNSURE, "radians, if these are angles: no joint goes beyond one turn"
    return (
        "deg",
        _UNSURE,
        "degrees where use_degrees was on, else −100 to 100 percent of the calibrated range: the data set does not say",
    )


def _missing(columns: dict[str, Proposed]) -> dict[str, str]:
    missing = {}
    if "position_command" not in columns:
        missing["effort"] = (
            "a data set of LeRobot has no torque; give a recording of the joint with effort or voltage"
        )
    return missing


def _notes(log: Log, moving: list[str], motion: dict[str, float], unit: str) -> Iterator[str]:
    yield f"The joint {moving[0]} moves most, by {motion[moving[0]]:.3g} {unit}."
    if len(moving) > 1:
        listed = ", ".join(f"{joint} ({motion[joint]:.3g})" for joint in moving[1:])
        yield f"Other joints that move: {listed}. To diagnose one, name it in the mapping."
    yield "Neither torque nor current is recorded: only a delay and what holds a joint off its target can be named."
    rate = log.facts.get("fps")
    if rate:
        yield f"At {rate} Hz a delay is known to some hundredths of a second at best."
