"""The time-optimal lap through the gates, by optimal control.

After Foehn, Romero & Scaramuzza 2021, "Time-optimal planning for quadrotor waypoint flight", Science Robotics 6:
progress through the gates is constrained, and the time is free. Here the lap has a phase of free duration for each
gate, at whose end the gate is passed within its opening; the end of the lap joins its start.
"""

from dataclasses import dataclass
from typing import Any

import casadi
import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.gates.track import Track
from simgap.policies.racing.settings import Flying

_STATE_SIZE, _INPUT_SIZE = 13, 4
_GUESSED_SPEED = 6.0  # m/s
_LEAST_SPEED = 0.1  # m/s, through a gate
_SMOOTHNESS_WEIGHT = 1e-5  # s per (rad/s²)²·s: settles what the time leaves open


@dataclass(frozen=True)
class Limits:
    """What the machine can do.

    Attributes:
        thrust: greatest, over mass, m/s².
        rate: greatest about body x and y, rad/s.
        yaw_rate: greatest about body z, rad/s.
        angular_acceleration: greatest about each axis, rad/s².
        margin: kept to the edge of an opening, beside the track's clearance, m.
    """

    thrust: float
    rate: float
    yaw_rate: float
    angular_acceleration: float = 60.0
    margin: float = 0.1

    @classmethod
    def of(cls, flying: Flying, share: float = 0.85) -> "Limits":
        """Return those of what may be commanded, with a share of the thrust, so that some is left to track with."""
        return cls(share * flying.thrust, flying.rate, flying.yaw_rate)


@dataclass(frozen=True)
class OptimalLap:
    """A lap from the last gate, or from a start, to the last gate.

    Attributes:
        times: of the nodes, (nodes + 1,) s from 0 to the lap time.
        states: (nodes + 1, 13): position, attitude, velocity (world), body rate.
        inputs: (nodes, 4): thrust over mass, m/s², and angular acceleration, rad/s²; each held to the next node.
        gates: node at which each gate is passed, (gates,).
    """

    times: NDArray[np.float64]
    states: NDArray[np.float64]
    inputs: NDArray[np.float64]
    gates: NDArray[np.int64]

    @property
    def duration(self) -> float:
        """The lap time, s."""
        return float(self.times[-1])


def optimal_lap(
    track: Track,
    limits: Limits,
    gravity: float,
    nodes: int = 12,
    ends: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None,
) -> OptimalLap:
    """Return the fastest lap that a rigid body with these limits can fly.

    Args:
        track: its gates, in the order in which they are passed.
        limits: of the machine.
        gravity: m/s².
        nodes: of each phase, between two gates.
        ends: states (13,) in which it starts and ends; None for a lap that ends as it begins.

    Raises:
        InputError: when no such lap is found.
    """
    gates = len(track)
    problem = casadi.Opti()
    state = problem.variable(_STATE_SIZE, gates * nodes + 1)
    command = problem.variable(_INPUT_SIZE, gates * nodes)
    duration = problem.variable(1, gates)
    step = casadi.kron(duration / nodes, casadi.DM.ones(1, nodes))
    problem.subject_to(state[:, 1:] == _motion(gravity).map(gates * nodes)(state[:, :-1], command, step))
    _join(problem, state[:, 0], state[:, -1], ends)
    _bound(problem, state, command, duration, limits)
    _stay_inside(problem, state, track)
    for gate in range(gates):
        _pass(problem, state[:, (gate + 1) * nodes], track, gate, limits)
    effort = casadi.sum2(casadi.sum1(command[1:, :] ** 2) * step)
    problem.minimize(casadi.sum2(duration) + _SMOOTHNESS_WEIGHT * effort)
    _guess(problem, state, command, duration, track, nodes, gravity)
    problem.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes", "max_iter": 1000})
    try:
        solution = problem.solve()
    except RuntimeError as error:
        raise InputError(
            "no time-optimal lap was found", "track", "give more nodes or wider limits"
        ) from error
    lengths = np.atleast_1d(solution.value(duration)).repeat(nodes) / nodes
    return OptimalLap(
        np.concatenate([[0.0], np.cumsum(lengths)]),
        np.asarray(solution.value(state)).T,
        np.asarray(solution.value(command)).T,
        nodes * np.arange(1, gates + 1),
    )


def _motion(gravity: float) -> Any:
    """Return a step of Runge and Kutta's rule of a rigid body without air: (13), (4), s → (13)."""
    state, command, step = (
        casadi.MX.sym(name, size) for name, size in (("x", _STATE_SIZE), ("u", _INPUT_SIZE), ("h", 1))
    )

    def rate(x: Any) -> Any:
        w, i, j, k = casadi.vertsplit(x[3:7])
        axis = casadi.vertcat(2 * (i * k + w * j), 2 * (j * k - w * i), 1 - 2 * (i * i + j * j))
        p, q, r = casadi.vertsplit(x[10:13])
        turning = 0.5 * casadi.vertcat(
            -i * p - j * q - k * r, w * p + j * r - k * q, w * q - i * r + k * p, w * r + i * q - j * p
        )
        falling = casadi.DM([0.0, 0.0, -gravity])
        return casadi.vertcat(x[7:10], turning, command[0] * axis + falling, command[1:])

    first = rate(state)
    second = rate(state + 0.5 * step * first)
    third = rate(state + 0.5 * step * second)
    fourth = rate(state + step * third)
    after = state + step / 6 * (first + 2 * second + 2 * third + fourth)
    unit = casadi.vertcat(after[:3], after[3:7] / casadi.norm_2(after[3:7]), after[7:])
    return casadi.Function("motion", [state, command, step], [unit])


def _join(
    problem: Any, first: Any, last: Any, ends: tuple[NDArray[np.float64], NDArray[np.float64]] | None
) -> None:
    """Let the lap end as it began, or start and end in given states."""
    if ends is None:
        problem.subject_to(casadi.sumsqr(first[3:7]) == 1)
        _same(problem, last, first)
    else:
        problem.subject_to(first == casadi.DM(ends[0]))
        _same(problem, last, casadi.DM(ends[1]))


def _same(problem: Any, state: Any, other: Any) -> None:
    """Let a state be another; a quaternion may be its negative."""
    for part in (slice(0, 3), slice(7, 13)):
        problem.subject_to(state[part] == other[part])
    # Of the rotation between the two nothing but the scalar may be left.
    turned = other[3] * state[4:7] - state[3] * other[4:7] - casadi.cross(other[4:7], state[4:7])
    problem.subject_to(turned == 0)


def _bound(problem: Any, state: Any, command: Any, duration: Any, limits: Limits) -> None:
    turning = limits.angular_acceleration
    problem.subject_to(problem.bounded(0, command[0, :], limits.thrust))
    problem.subject_to(problem.bounded(-turning, casadi.vec(command[1:, :]), turning))
    problem.subject_to(problem.bounded(-limits.rate, casadi.vec(state[10:12, :]), limits.rate))
    problem.subject_to(problem.bounded(-limits.yaw_rate, state[12, :], limits.yaw_rate))
    problem.subject_to(problem.bounded(0.05, casadi.vec(duration), 20.0))


def _stay_inside(problem: Any, state: Any, track: Track) -> None:
    low, high = track.box.double().numpy()
    for axis in range(3):
        room = (low[axis] + track.clearance, high[axis] - track.clearance)
        problem.subject_to(problem.bounded(room[0], state[axis, :], room[1]))


def _pass(problem: Any, state: Any, track: Track, gate: int, limits: Limits) -> None:
    axes = casadi.DM(track.axes[gate].double().numpy())
    place = axes @ (state[:3] - casadi.DM(track.centres[gate].double().numpy()))
    half = 0.5 * track.opening - track.clearance - limits.margin
    problem.subject_to(place[0] == 0)
    problem.subject_to(problem.bounded(-half, place[1:], half))
    problem.subject_to(axes[0, :] @ state[7:10] >= _LEAST_SPEED)


def _guess(
    problem: Any, state: Any, command: Any, duration: Any, track: Track, nodes: int, gravity: float
) -> None:
    """Begin level, on straight lines from gate to gate."""
    centres = track.centres.double().numpy()
    before = np.roll(centres, 1, axis=0)
    lengths = np.linalg.norm(centres - before, axis=1)
    share = np.arange(1, nodes + 1)[:, None] / nodes
    way = [a + share * (b - a) for a, b in zip(before, centres, strict=True)]
    velocity = np.repeat((centres - before) / lengths[:, None] * _GUESSED_SPEED, nodes, axis=0)
    problem.set_initial(state, 0.0)
    problem.set_initial(state[:3, :], np.vstack([before[:1], *way]).T)
    problem.set_initial(state[3, :], 1.0)
    problem.set_initial(state[7:10, :], np.vstack([velocity[:1], velocity]).T)
    problem.set_initial(command[0, :], gravity)
    problem.set_initial(duration, lengths[None] / _GUESSED_SPEED)
