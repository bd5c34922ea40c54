"""Columns of a swerve drive in a robot's log: measured states, volts, speeds and currents of each module."""

from collections.abc import Mapping

import numpy as np

from simgap.logs.log import Log, Signal
from simgap.logs.mapping import Source
from simgap.logs.proposal import Proposal, Proposed, lacking
from simgap.logs.wpilog.advice import HOW, NO_DUTY, SWERVE
from simgap.logs.wpilog.checks import moves, speed_at_supply
from simgap.logs.wpilog.modules import Found, modules_of
from simgap.logs.wpilog.words import words_in, words_of
from simgap.recordings.units import conversion

_COLUMNS = {
    "drive_voltage": ("drive", "voltage", "V"),
    "steer_voltage": ("steer", "voltage", "V"),
    "steer_velocity": ("steer", "velocity", "rad/s"),
    "steer_angle": ("steer", "position", "rad"),
    "drive_current": ("drive", "current", "A"),
    "steer_current": ("steer", "current", "A"),
}
_GEAR = 300.0  # rad/s at 12 V: motors of the FRC turn at 500 and more (CIM 558, NEO 594), module wheels at 150 and less
_NAMED, _UNSURE = 0.95, 0.6
_DUTY_MOST = 1.5  # a greater duty is in per cent
_OF_A_DRIVE = frozenset({"drive", "drivetrain", "chassis", "swerve"})
_MEASURED = {"measured", "actual", "current", "state", "robot", "speeds"}


def propose_swerve(log: Log) -> Proposal:
    """Propose the columns of a swerve drive; see `simgap.logs.proposal.propose`."""
    modules = modules_of(log.signals)
    battery = battery_of(log.signals)
    columns: dict[str, Proposed] = {}
    for column, (group, quantity, unit) in _COLUMNS.items():
        for number, signal in modules.get((group, quantity), {}).items():
            if (entry := _named(signal, unit)) is not None:
                columns[f"{column}_{number}"] = entry
    columns |= _drive_velocities(modules) | _duties(modules, battery, columns) | _chassis(log.signals)
    if battery is not None:
        columns["battery_voltage"] = Proposed(Source(battery.name, "V"), _NAMED, "its name")
    columns = {name: entry for name, entry in sorted(columns.items()) if not _is_partial(name, columns)}
    return Proposal(
        "swerve", columns, _missing(columns, modules), notes=_notes(columns), refusal=_refusal(log, modules)
    )


def battery_of(signals: Mapping[str, Signal]) -> Signal | None:
    """Return the voltage of the battery, where it was logged."""
    found = [
        signal
        for name, signal in signals.items()
        if {"battery", "voltage"} <= set(words_in(name)) or name.endswith("PowerDistribution/Voltage")
    ]
    return max(found, key=lambda signal: len(signal.time), default=None)


def duty_of(signals: Mapping[str, Signal], words: frozenset[str] = frozenset()) -> str | None:
    """Return the name of a signal that is a motor's duty, the one that changes most often; None where there is none.

    Args:
        signals: of the log.
        words: of which the name must have one; any name where there are none.
    """
    found = [
        signal
        for signal in signals.values()
        if words_of(signal).quantity == "duty"
        or {"motor", "speed"} <= set(words_in(signal.name.rsplit("/", 1)[-1]))
        if np.nanmax(np.abs(signal.values), initial=0.0) <= _DUTY_MOST
        if not words or words & set(words_in(signal.name))
    ]
    best = max(found, key=lambda signal: len(signal.time), default=None)
    return None if best is None else best.name


def _named(signal: Signal, unit: str) -> Proposed | None:
    """Return a column by the name of its signal; None where its unit is another sort of quantity."""
    if signal.unit is None:
        return Proposed(Source(signal.name, unit), _UNSURE, "its name; the log says no unit")
    found = conversion(signal.unit)
    held = True if unit == "V" else None
    return (
        Proposed(Source(signal.name, held=held), _NAMED, "its name") if found and found[0] == unit else None
    )


def _drive_velocities(modules: Found) -> dict[str, Proposed]:
    """Return the speeds of the drive motors; a log as a rule has those of the wheels, behind the gear."""
    columns = {}
    for number, signal in modules.get(("drive", "velocity"), {}).items():
        found = conversion(signal.unit) if signal.unit else None
        column = f"drive_velocity_{number}"
        if found is None or found[0] not in ("m/s", "rad/s"):
            columns[column] = Proposed(
                Source(signal.name, "rad/s"), _UNSURE, "its name; the log says no unit"
            )
        elif found[0] == "m/s":
            source = Source(signal.name, "rad/s", scale=found[1], ratio="drive.gear_ratio / wheel_radius")
            columns[column] = Proposed(
                source, _NAMED, "a speed over the floor, times gear ratio over wheel radius"
            )
        else:
            columns[column] = _turning(signal, found[1], modules.get(("drive", "voltage"), {}).get(number))
    return columns


def _turning(signal: Signal, factor: float, voltage: Signal | None) -> Proposed:
    """Return the speed of a drive motor that is logged in turns: of the motor, or of the wheel."""
    speed = None if voltage is None else speed_at_supply(voltage, signal)
    wheel = Source(signal.name, "rad/s", scale=factor, ratio="drive.gear_ratio")
    if "rotor" in words_in(signal.name) or (speed is not None and speed * factor > _GEAR):
        return Proposed(Source(signal.name), _NAMED, "a motor's speed by its name or its volts")
    if speed is None:
        return Proposed(wheel, _NAMED, "of the wheel, as AdvantageKit has it: behind the gear")
    return Proposed(wheel, _NAMED, f"of the wheel, behind the gear: {speed * factor:.3g} rad/s at 12 V")


def _duties(modules: Found, battery: Signal | None, present: Mapping[str, Proposed]) -> dict[str, Proposed]:
    """Return volts as duty times the battery's voltage, for a person to confirm."""
    if battery is None:
        return {}
    columns = {}
    for group in ("drive", "steer"):
        for number, signal in modules.get((group, "duty"), {}).items():
            name = f"{group}_voltage_{number}"
            scale = 1.0 if np.nanmax(np.abs(signal.values), initial=0.0) <= _DUTY_MOST else 0.01
            if name not in present:
                source = Source(signal.name, "V", scale=scale, held=True, times=battery.name)
                columns[name] = Proposed(
                    source, _UNSURE, "a duty times the battery's voltage: no measured voltage"
                )
    return columns


def _chassis(signals: Mapping[str, Signal]) -> dict[str, Proposed]:
    """Return the chassis's measured speeds in the robot's frame, where one signal alone is named so."""
    found = [
        name.removesuffix("/vx")
        for name, signal in signals.items()
        if name.endswith("/vx") and signal.unit == "m/s" and not words_of(signal).wanted
        if set(words_in(name)) & _MEASURED and "field" not in words_in(name)
        if {f"{name.removesuffix('/vx')}/vy", f"{name.removesuffix('/vx')}/omega"} <= set(signals)
    ]
    if len(found) != 1:
        return {}
    fields = {"chassis_velocity_x": "vx", "chassis_velocity_y": "vy", "chassis_rate": "omega"}
    return {
        column: Proposed(
            Source(f"{found[0]}/{field}"), _NAMED, "measured ChassisSpeeds: forward, left, to the left"
        )
        for column, field in fields.items()
    }


def _is_partial(name: str, columns: Mapping[str, Proposed]) -> bool:
    """Return whether a column is an optional one of four, of which not all are there and sure."""
    if not name.startswith(("drive_current_", "steer_current_")):
        return False
    return not all(f"{name[:-1]}{number}" in columns for number in range(1, 5))


def _missing(columns: Mapping[str, Proposed], modules: Found) -> dict[str, str]:
    missing = {}
    for column in lacking("swerve", set(columns)):
        stem = column[:-2]
        duty = modules.get((stem.split("_")[0], "duty"), {}) if stem.endswith("_voltage") else {}
        said = f"{NO_DUTY.format(next(iter(duty.values())).name)}: " if duty else ""
        first = next((f"{stem}_{number}" for number in range(1, 5) if f"{stem}_{number}" in missing), None)
        missing[column] = f"as {first}" if first else f"{said}{SWERVE[stem]}; {HOW}"
    return missing


def _notes(columns: Mapping[str, Proposed]) -> tuple[str, ...]:
    if not any(entry.source.ratio for entry in columns.values()):
        return ()
    return (
        "The drive speeds were logged behind the gear; the gear ratio of the platform makes them the motors'.",
    )


def _refusal(log: Log, modules: Found) -> str:
    if not modules:
        duty = duty_of(log.signals, _OF_A_DRIVE)
        said = f"; {NO_DUTY.format(duty)}" if duty else ""
        return f"no module of a swerve drive was logged{said}: {SWERVE['drive_voltage']}; {HOW}"
    motions = [("drive", "velocity"), ("steer", "position"), ("steer", "velocity")]
    if not moves(signal for key in motions for signal in modules.get(key, {}).values()):
        return f"the modules do not move in this log: record a drive; {HOW}"
    return ""
