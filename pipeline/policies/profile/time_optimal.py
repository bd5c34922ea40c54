"""Time-optimal bound: the fastest motion from rest to rest within the limits of a drive."""

import math
from typing import Any

import casadi
import torch

from simgap.errors import InputError
from simgap.policies.profile.drive import Drive
from simgap.policies.profile.motion import Motion, drive_open_loop

_QUIET: dict[str, Any] = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes"}}


def time_optimal(drive: Drive, distance: float, speed: float = math.inf, intervals: int = 200) -> Motion:
    """Return the fastest motion from rest to rest by optimal control with free final time.

    Direct multiple shooting with voltages that are held over equal intervals, each of which is integrated exactly; the
    drive never rolls back, so that friction has one direction. Betts 2010, "Practical methods for optimal control and
    estimation using nonlinear programming", §3.4. The wheels are taken as one, with the mean of their constants.

    Args:
        drive: identified.
        distance: m.
        speed: greatest, m/s.
        intervals: over the whole time; the error goes down with their square.

    Raises:
        InputError: when the voltage does not overcome friction.
    """
    static, per_speed, per_acceleration = (
        float(constant.double().mean()) for constant in (drive.static, drive.speed, drive.acceleration)
    )
    bound, time_constant = drive.voltage_limit, per_acceleration / per_speed
    if bound <= static:
        raise InputError("does not overcome friction", f"a voltage of {bound:g} V", "allow more")
    fastest = min(speed, (bound - static) / per_speed)
    problem = casadi.Opti()
    duration, voltage = problem.variable(), problem.variable(intervals)
    velocity, position = problem.variable(intervals + 1), problem.variable(intervals + 1)
    step = duration / intervals
    settled, before = (voltage - static) / per_speed, velocity[:-1]
    gone = 1.0 - casadi.exp(-step / time_constant)
    away = before - settled
    problem.subject_to(velocity[1:] == before - away * gone)
    problem.subject_to(position[1:] - position[:-1] == settled * step + away * time_constant * gone)
    problem.subject_to(problem.bounded(-bound, voltage, bound))
    if math.isfinite(drive.acceleration_limit):
        change = drive.acceleration_limit * step
        problem.subject_to(problem.bounded(-change, velocity[1:] - before, change))
    problem.subject_to(problem.bounded(0.0, velocity, fastest))
    problem.subject_to(casadi.vertcat(position[0], velocity[0], velocity[-1]) == 0.0)
    problem.subject_to(position[-1] == distance)
    problem.minimize(duration)
    _guess(problem, duration, velocity, position, distance / fastest + 2.0 * time_constant, distance)
    problem.solver("ipopt", _QUIET)
    found = problem.solve()
    held = torch.as_tensor(found.value(voltage)).to(drive.speed)
    period = float(found.value(step))
    return drive_open_loop(drive, held[:, None].expand(-1, len(drive.speed)), period)


def _guess(problem: Any, duration: Any, velocity: Any, position: Any, time: float, distance: float) -> None:
    """Start the search from an even speed."""
    problem.subject_to(duration >= 0.0)
    problem.set_initial(duration, time)
    problem.set_initial(velocity, distance / time)
    problem.set_initial(position, casadi.linspace(0.0, distance, position.shape[0]))
