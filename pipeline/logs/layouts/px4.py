"""PX4: north, east, down and forward, right, down; motors in the order of the airframe.

Topics: https://docs.px4.io/main/en/msg_docs/; frames and parameters: its pages on airframes and parameters.
"""

from collections.abc import Mapping, Sequence

import numpy as np

from simgap.logs.layouts.choices import (
    AXES,
    QUATERNION,
    Choice,
    choose,
    moves,
    vector,
)
from simgap.logs.layouts.flights import Stretch, flights, height_of, states_at, stretches
from simgap.logs.layouts.placeless import whole_or_none
from simgap.logs.layouts.px4_motors import battery, commands, order, places, speeds
from simgap.logs.layouts.px4_vehicle import not_a_quadrotor
from simgap.logs.layouts.rates import rated
from simgap.logs.layouts.refusals import no_flight, too_slow, wrong_kind
from simgap.logs.log import Log, Signal
from simgap.logs.proposal import Proposal, Proposed, lacking

HOW = (
    "list the topics without an interval in etc/logging/logger_topics.txt on the SD card "
    "(docs/how_to/px4.md has the file)"
)
_ARMED = 2.0  # of vehicle_status.arming_state
_STATE = (
    ("position", "vehicle_local_position{}", ("x", "y", "z"), AXES, "m"),
    ("velocity", "vehicle_local_position{}", ("vx", "vy", "vz"), AXES, "m/s"),
    ("attitude", "vehicle_attitude{}", ("q[0]", "q[1]", "q[2]", "q[3]"), QUATERNION, "1"),
    ("body_rate", "vehicle_angular_velocity{}", ("xyz[0]", "xyz[1]", "xyz[2]"), AXES, "rad/s"),
)
_TRUTH = "_groundtruth"


def propose(log: Log, kind: str | None) -> Proposal | None:
    """Propose the columns of a log of PX4; None for other logs.

    Args:
        log: as it was read.
        kind: of the platform; another than a quadrotor is refused.
    """
    if log.format != "PX4 ULog":
        return None
    columns, missing, notes = _state(log)
    for found in (_inputs(log, missing, notes), _sensed(log), battery(log, missing)):
        columns |= found
    notes.append(order(log))
    height = height_of(log, [(f"vehicle_local_position{tail}.z", -1.0) for tail in (_TRUTH, "")])
    windows = flights(_said(log), height)
    fast = rated(log, columns, HOW)
    refusal = (
        wrong_kind(kind)
        or not_a_quadrotor(log)
        or ("" if windows else _no_flight(log, height))
        or _slow(log, fast.refused)
    )
    missing |= fast.missing
    columns, left_out = whole_or_none(fast.columns)
    for column in lacking("quadrotor", set(columns)):
        missing.setdefault(column, HOW)
    return Proposal(
        "quadrotor", columns, missing, windows, (*notes, *fast.notes, *left_out), refusal, places=places(log)
    )


def _state(log: Log) -> tuple[dict[str, Proposed], dict[str, str], list[str]]:
    """Return the state: of the simulator where it was logged, with the estimator's beside it; else the estimator's."""
    columns: dict[str, Proposed] = {}
    missing: dict[str, str] = {}
    notes: list[str] = []
    truth_used = False
    for group, topic, fields, signs, unit in _STATE:
        names = [f"{group}_{axis}" for axis in ("wxyz" if group == "attitude" else "xyz")]
        estimated = _estimator(log, group, topic, fields, signs, unit)
        truth = choose(log, [vector(topic.format(_TRUTH), fields, "of the simulator", signs, unit)])
        if truth is not None:
            columns |= truth.columns(names)
            truth_used = True
            if estimated is not None:
                columns |= estimated.columns([f"estimate_{name}" for name in names])
        elif estimated is not None:
            columns |= estimated.columns(names)
        else:
            missing |= dict.fromkeys(names, _how(group))
    if truth_used:
        notes.append(
            "The state is the simulator's (groundtruth topics); the estimator's is beside it as estimate_*."
        )
    else:
        notes.append("The state is the on-board estimator's: its delays and its smoothing are in it.")
    return columns, missing, notes


def _estimator(
    log: Log, group: str, topic: str, fields: Sequence[str], signs: Sequence[int], unit: str
) -> Choice | None:
    name = topic.format("")
    if group in ("position", "velocity") and not moves(log, [f"{name}.x", f"{name}.y"]):
        return None  # without a fix the estimator holds zero
    choices = [vector(name, fields, "PX4 defines it", signs, unit)]
    if group == "body_rate":
        choices += [
            vector(
                "sensor_combined", [f"gyro_rad[{axis}]" for axis in range(3)], "the gyroscope", signs, unit
            ),
            vector("vehicle_attitude", ["rollspeed", "pitchspeed", "yawspeed"], "PX4 up to 1.9", signs, unit),
        ]
    return choose(log, choices)


def _how(group: str) -> str:
    if group in ("position", "velocity"):
        return f"the estimator has no horizontal {group}: fly with GPS or motion capture, and {HOW}"
    return HOW


def _inputs(log: Log, missing: dict[str, str], notes: list[str]) -> dict[str, Proposed]:
    columns: dict[str, Proposed] = {}
    for name, choice in (("motor_command", commands(log, notes)), ("motor_speed", speeds(log))):
        if choice is not None:
            columns |= choice.columns([f"{name}_{rotor}" for rotor in range(1, 5)])
    if not columns:
        advice = f"log actuator_motors (1.13 and later) or actuator_outputs: {HOW}"
        missing |= dict.fromkeys((f"motor_command_{rotor}" for rotor in range(1, 5)), advice)
    return columns


def _sensed(log: Log) -> dict[str, Proposed]:
    """Return what helps, but is not needed: specific force, and the commanded body rate."""
    columns: dict[str, Proposed] = {}
    force = choose(
        log,
        [
            vector(
                "vehicle_acceleration", [f"xyz[{axis}]" for axis in range(3)], "PX4 defines it", AXES, "m/s²"
            ),
            vector(
                "sensor_combined",
                [f"accelerometer_m_s2[{axis}]" for axis in range(3)],
                "the accelerometer",
                AXES,
                "m/s²",
            ),
        ],
    )
    wanted = choose(
        log, [vector("vehicle_rates_setpoint", ["roll", "pitch", "yaw"], "PX4 defines it", AXES, "rad/s")]
    )
    for name, choice in (("specific_force", force), ("body_rate_command", wanted)):
        if choice is not None:
            columns |= choice.columns([f"{name}_{axis}" for axis in "xyz"])
    return columns


def _said(log: Log) -> list[Stretch]:
    """Return when the vehicle says that it is armed and not landed; all of the log where it says neither."""
    flags = [
        (signal, missing, value)
        for name, missing, value in (
            ("vehicle_land_detected.landed", 1.0, 0.0),
            ("actuator_armed.armed", 0.0, 1.0),
            ("vehicle_status.arming_state", 0.0, _ARMED),
        )
        if (signal := log.signals.get(name)) is not None and len(signal.time)
    ]
    begin, end = _extent(log)
    if not flags:
        return [Stretch(begin, end)]
    times = np.unique(np.concatenate([np.empty(0), *(signal.time for signal, _, _ in flags)]))
    flying = np.ones(len(times), dtype=bool)
    for signal, missing, value in flags:
        flying &= states_at(times, signal, missing) == value
    return stretches(times, flying, end)


def _extent(log: Log) -> tuple[float, float]:
    """Return the first and last time of what is always logged."""
    names = ("vehicle_local_position.z", "vehicle_attitude.q[0]", "sensor_combined.gyro_rad[0]")
    times = [log.signals[name].time for name in names if name in log.signals]
    known = [time for time in times if len(time)]
    return min((float(time[0]) for time in known), default=0.0), max(
        (float(time[-1]) for time in known), default=0.0
    )


def _no_flight(log: Log, height: Signal | None) -> str:
    flags = [
        log.signals[name].values == value
        for name, value in (("actuator_armed.armed", 1), ("vehicle_status.arming_state", _ARMED))
        if name in log.signals
    ]
    armed = not flags or any(np.any(flag) for flag in flags)
    return no_flight(height) if armed else "nothing flies in it: the vehicle is never armed; log a flight"


def _slow(log: Log, rates: Mapping[str, float]) -> str:
    """Return why the physics cannot be seen at the rates of a log; empty where it can."""
    profile = f" (SDLOG_PROFILE is {log.facts['SDLOG_PROFILE']})" if "SDLOG_PROFILE" in log.facts else ""
    return too_slow(rates, HOW + profile) if rates else ""
