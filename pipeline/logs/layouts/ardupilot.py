"""ArduPilot Copter: north, east, down and forward, right, down; motors in the order of its frames.

Messages: https://ardupilot.org/copter/docs/logmessages.html.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from simgap.logs.layouts.airframes import places_of
from simgap.logs.layouts.ardupilot_events import crash_free, said
from simgap.logs.layouts.ardupilot_motors import battery, commands, order, rotors, speeds
from simgap.logs.layouts.choices import AXES, QUATERNION, Choice, choose, largest, moves, number, vector
from simgap.logs.layouts.flights import flights, height_of
from simgap.logs.layouts.placeless import whole_or_none
from simgap.logs.layouts.rates import rated
from simgap.logs.layouts.refusals import no_flight, too_slow, wrong_kind
from simgap.logs.log import Log, Span
from simgap.logs.proposal import Proposal, Proposed, lacking

HOW = "set bits 0 (fast attitude) and 18 (fast IMU) of LOG_BITMASK"
MOTORS = (
    "RCOU is written at 10 Hz whatever LOG_BITMASK says, so set its bit 0 (fast attitude), which fills RATE, or let "
    "the speed controllers tell their speeds: bidirectional DShot, SERVO_BLH_BDMASK 15, fills ESC (docs/how_to/px4.md)"
)
_CLASSES = {
    2: "hexacopter", 3: "octocopter", 4: "octocopter", 5: "Y6", 6: "helicopter", 7: "tricopter", 8: "single copter",
    9: "coaxial copter", 10: "tailsitter", 11: "helicopter", 12: "dodecacopter", 13: "helicopter", 14: "decacopter",
}  # fmt: skip
"""FRAME_CLASS that are no quadrotors."""
_FASTEST = 2000.0
"""deg/s: no gyroscope of a flight controller tells more."""
_FILTERS = ("XKF1", "NKF1", "EKF1")  # of the newest estimator first
_HEIGHTS = (
    ("SIM2.PD", -1.0),
    *((f"{name}.PD", -1.0) for name in _FILTERS),
    ("CTUN.Alt", 1.0),
    ("BARO.Alt", 1.0),
)


def propose(log: Log, kind: str | None) -> Proposal | None:
    """Propose the columns of a log of ArduPilot; None for other logs.

    Args:
        log: as it was read.
        kind: of the platform; another than a quadrotor is refused.
    """
    if log.format != "ArduPilot DataFlash":
        return None
    missing: dict[str, str] = {}
    notes: list[str] = []
    height = height_of(log, _HEIGHTS)
    windows = crash_free(log, flights(said(log), height))
    columns = _state(log, missing, notes) | _inputs(log, windows, notes) | battery(log, missing)
    columns |= _sensed(log)
    notes.append(order(log))
    fast = rated(log, columns, HOW)
    refusal = (
        wrong_kind(kind)
        or _not_a_quadrotor(log)
        or ("" if windows else no_flight(height))
        or _slow(fast.refused)
    )
    missing |= fast.missing
    columns, left_out = whole_or_none(fast.columns)
    for column in lacking("quadrotor", set(columns)):
        missing.setdefault(column, MOTORS if column.startswith("motor") else HOW)
    return Proposal(
        "quadrotor",
        columns,
        missing,
        windows,
        (*notes, *fast.notes, *left_out),
        refusal,
        places=places_of(rotors(log)),
    )


def _state(log: Log, missing: dict[str, str], notes: list[str]) -> dict[str, Proposed]:
    """Return the state: of the simulator where it was logged, with the estimator's beside it; else the estimator's."""
    truth = {
        "position": vector("SIM2", ("PN", "PE", "PD"), "of the simulator", AXES, "m"),
        "velocity": vector("SIM2", ("VN", "VE", "VD"), "of the simulator", AXES, "m/s"),
        "attitude": vector("SIM", ("Q1", "Q2", "Q3", "Q4"), "of the simulator", QUATERNION, "1"),
    }
    columns: dict[str, Proposed] = {}
    for group in ("position", "velocity", "attitude", "body_rate"):
        names = [f"{group}_{axis}" for axis in ("wxyz" if group == "attitude" else "xyz")]
        estimated = _estimator(log, group)
        true = choose(log, [truth[group]]) if group in truth else None
        if true is not None:
            columns |= true.columns(names)
            if estimated is not None:
                columns |= estimated.columns([f"estimate_{name}" for name in names])
        elif estimated is not None:
            columns |= estimated.columns(names)
        else:
            missing |= dict.fromkeys(names, _how(group))
    simulated = choose(log, [truth["position"]]) is not None
    notes.append(
        "The state is the simulator's (SIM, SIM2); the estimator's is beside it as estimate_*."
        if simulated
        else "The state is the on-board estimator's: its delays and its smoothing are in it."
    )
    return columns


def _sensed(log: Log) -> dict[str, Proposed]:
    """Return what helps, but is not needed: specific force, and the commanded body rate."""
    columns: dict[str, Proposed] = {}
    wanted = choose(log, [_controlled(log, ("RDes", "PDes", "YDes"))])
    force = choose(log, [vector("IMU", ("AccX", "AccY", "AccZ"), "the accelerometer", AXES, "m/s²")])
    for name, choice in (("body_rate_command", wanted), ("specific_force", force)):
        if choice is not None:
            columns |= choice.columns([f"{name}_{axis}" for axis in "xyz"])
    return columns


def _controlled(log: Log, fields: Sequence[str]) -> Choice:
    """Return the choice of body rates that the rate controller tells: old firmware in hundredths of a degree.

    A log of Copter 3.4-dev (2015) does so; its rates say it, which are beyond any gyroscope.
    """
    found = vector("RATE", fields, "the rate controller", AXES, "deg/s")
    if max(largest(log, name) for name in found.signals) < _FASTEST:
        return found
    reason = "the rate controller, in hundredths of a degree per second"
    return replace(found, reason=reason, scales=[0.01] * len(fields))


def _slow(rates: Mapping[str, float]) -> str:
    """Return why the physics cannot be seen at the rates of a log; empty where it can."""
    return too_slow(rates, MOTORS if set(rates) & {"RCOU", "ESC"} else HOW) if rates else ""


def _estimator(log: Log, group: str) -> Choice | None:
    if group == "attitude":
        quaternions = [("XKQ", "of the estimator"), ("NKQ", "of the estimator"), ("NKQ1", "of the estimator")]
        return choose(
            log,
            [
                *(
                    vector(name, ("Q1", "Q2", "Q3", "Q4"), reason, QUATERNION, "1")
                    for name, reason in quaternions
                ),
                vector("ATT.quaternion", "wxyz", "of roll, pitch and yaw", QUATERNION, "1"),
            ],
        )
    if group == "body_rate":
        return choose(
            log,
            [
                vector("IMU", ("GyrX", "GyrY", "GyrZ"), "the gyroscope", AXES, "rad/s"),
                _controlled(log, ("R", "P", "Y")),
            ],
        )
    present = [name for name in _FILTERS if moves(log, _plane(name))]  # without a fix it holds zero
    fields: Sequence[str] = ("PN", "PE", "PD") if group == "position" else ("VN", "VE", "VD")
    unit = "m" if group == "position" else "m/s"
    return choose(log, [vector(name, fields, "of the estimator", AXES, unit) for name in present])


def _plane(name: str) -> list[str]:
    return [f"{name}.PN", f"{name}.PE"]


def _how(group: str) -> str:
    if group in ("position", "velocity"):
        return f"the estimator has no horizontal {group}: fly with GPS or motion capture, and {HOW}"
    return HOW


def _inputs(log: Log, windows: Sequence[Span], notes: list[str]) -> dict[str, Proposed]:
    columns: dict[str, Proposed] = {}
    for name, choice in (("motor_command", commands(log, windows, notes)), ("motor_speed", speeds(log))):
        if choice is not None:
            columns |= choice.columns([f"{name}_{rotor}" for rotor in range(1, 5)])
    return columns


def _not_a_quadrotor(log: Log) -> str:
    vehicle = log.facts.get("vehicle", "Copter")
    frame = log.facts.get("frame", "QUAD").partition("/")[0].upper()
    name = _CLASSES.get(int(number(log, "FRAME_CLASS") or 0))
    if vehicle != "Copter":
        name = "VTOL" if vehicle == "Plane" and number(log, "Q_ENABLE") else vehicle.lower()
    elif name is None and "QUAD" not in frame:
        name = f"copter with the frame {frame}"
    if name is None:
        return ""
    firmware = f" ({log.facts['firmware']})" if "firmware" in log.facts else ""
    return f"is a log of a {name}{firmware}, not of a quadrotor; only vehicles with four fixed rotors are modelled"
