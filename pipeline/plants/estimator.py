"""State estimator of the machine: visual-inertial odometry with drift, landmark updates and latency.

The errors follow from what is flown, as on a real machine (Kaufmann et al. 2023, Nature 620: odometry drifts at high
speed and rate). A camera misjudges speed by a share of it, and more so while turning; sideways acceleration is taken
for a tilt; what velocity is wrong adds up in position until a gate is seen. Where there are no gates to look for, what
else is seen on the way is not modelled, and position forgets its drift within 2 s, if it forgets.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from simgap.plants.case import PlantCase
from simgap.plants.flight import Log
from simgap.plants.gates_seen import IMAGE, GatesSeen, Look
from simgap.plants.rotation import Array, cross, from_small_angles, matrix, product
from simgap.plants.sampling import at
from simgap.plants.wind import first_order_noise

DELAY = 0.008  # s
STEP = 0.01  # s, of the errors where they follow a log
_FORGETS = 2.0  # s, correlation time of what is random, and of the drift of position
_SPEED_SHARE = -0.012  # by which speed is misjudged, on every flight
_SPEED_SPREAD = 0.006  # standard deviation of that share between flights
_BLUR = 0.15  # s/rad, of the random error of velocity while turning
_TILT = 0.025  # rad of tilt for specific force that stands at right angles to what is up
_RANDOM = {"velocity": 0.05, "attitude": 0.008, "body_rate": 0.02}
"""Standard deviations at a scale of 1: m/s, rad about each body axis, rad/s."""


@dataclass(frozen=True)
class Errors:
    """Errors of the estimate, (runs, 3) each, or (steps, runs, 3).

    Attributes:
        position: world frame, m.
        velocity: world frame, m/s.
        attitude: from the true to the believed, about the body's axes, rad.
        body_rate: rad/s.
    """

    position: Array
    velocity: Array
    attitude: Array
    body_rate: Array


@runtime_checkable
class Sight(Protocol):
    """What cameras of machines take off the drift of their odometry, asked a `STEP` apart.

    Attributes:
        in_view: whether the last image showed a gate, (runs,) bool.
        counts: what was seen so far, by name, (runs,) each.
    """

    in_view: NDArray[np.bool_]
    counts: Mapping[str, NDArray[np.int_]]

    def corrected(self, states: Array, believed: Array) -> Array:
        """Return what is believed of true states (runs, 13) instead of what odometry believes of them."""
        ...


@dataclass(frozen=True)
class Aid:
    """What takes the drift off the odometry of machines.

    Attributes:
        look: for gates, whose distances say how well they do; None: gates are not looked for so.
        sight: of cameras whose images do it instead.
        forgets: whether drift goes by itself where there is neither.
    """

    look: Look | None = None
    sight: Sight | None = None
    forgets: bool = True

    @property
    def fades(self) -> float:
        """Share of the drift of position that goes by itself, 1/s."""
        return 1.0 / _FORGETS if self.forgets and not self.look and not self.sight else 0.0


class Odometry:
    """The errors of an on-board estimator along flights, all runs at once."""

    def __init__(
        self,
        scale: float,
        runs: int,
        steps: int,
        step: float,
        random: np.random.Generator,
        aid: Aid | None = None,
    ) -> None:
        """Draw what is random.

        Args:
            scale: on all errors.
            runs: flights.
            steps: for which they are asked at most.
            step: from one to the next, s.
            random: of the errors.
            aid: against the drift; None: it is forgotten by itself.
        """
        noise = first_order_noise((steps, runs, 9), step / _FORGETS, random)
        self._noise = dict(zip(_RANDOM, np.split(noise, 3, axis=-1), strict=True))
        self._share = _SPEED_SHARE + _SPEED_SPREAD * random.standard_normal((runs, 1))
        self._scale, self._step, self._index = scale, step, 0
        aid = aid or Aid()
        self._fades, self._sight = aid.fades, aid.sight
        self._drift = np.zeros((runs, 3))
        self._gates = GatesSeen(aid.look, runs, random) if aid.look else None

    @property
    def in_view(self) -> NDArray[np.bool_]:
        """Whether each machine sees a gate, (runs,) bool."""
        eyes = self._sight or self._gates
        return eyes.in_view.copy() if eyes else np.zeros(len(self._drift), dtype=bool)

    @property
    def counts(self) -> dict[str, NDArray[np.int_]]:
        """What the cameras of the machines have seen so far, by name, (runs,) each; nothing where none are read."""
        return {name: count.copy() for name, count in self._sight.counts.items()} if self._sight else {}

    def advance(self, state: Array, force: Array) -> Errors:
        """Return the errors a step later.

        Args:
            state: position, velocity (world), attitude, body rate, (runs, 13).
            force: specific, body frame, (runs, 3) m/s².
        """
        noise = {name: size * self._noise[name][self._index] for name, size in _RANDOM.items()}
        velocity, rate = state[:, 3:6], state[:, 10:]
        turning = 1.0 + _BLUR * np.linalg.norm(rate, axis=-1, keepdims=True)
        wrong = self._share * velocity + turning * noise["velocity"]
        self._go_on(wrong, state)
        errors = (
            self._drift,
            wrong,
            _feigned_tilt(state[:, 6:10], force) + noise["attitude"],
            noise["body_rate"],
        )
        scaled = Errors(*(self._scale * error for error in errors))
        return _corrected(self._sight, state, scaled) if self._sight else scaled

    def _go_on(self, wrong: Array, state: Array) -> None:
        """Add up in position what velocity is wrong, (runs, 3) m/s, and take off what is found out."""
        self._drift += self._step * (wrong - self._fades * self._drift)
        if self._gates and self._index % round(IMAGE / self._step) == 0:
            self._drift = self._gates.corrected(self._drift, state)
        self._index += 1


def _feigned_tilt(attitude: Array, force: Array) -> Array:
    """Return how far what is felt draws the believed attitude, (runs, 3) rad about the body's axes."""
    up = matrix(attitude)[:, 2]
    size = np.linalg.norm(force, axis=-1, keepdims=True)
    return _TILT * cross(force / np.maximum(size, 1e-6), up)


def believed_state(state: Array, errors: Errors) -> Array:
    """Return what is believed of states (runs, 13)."""
    attitude = product(state[:, 6:10], from_small_angles(errors.attitude))
    attitude /= np.linalg.norm(attitude, axis=-1, keepdims=True)
    moved = (state[:, :3] + errors.position, state[:, 3:6] + errors.velocity, attitude)
    return np.concatenate((*moved, state[:, 10:] + errors.body_rate), axis=-1)


def _corrected(sight: Sight, state: Array, errors: Errors) -> Errors:
    """Return errors after a camera has corrected position and velocity of true states (runs, 13)."""
    wrong = sight.corrected(state, believed_state(state, errors)) - state
    return replace(errors, position=wrong[:, :3], velocity=wrong[:, 3:6])


def errors_along(log: Log, case: PlantCase, random: np.random.Generator) -> Errors:
    """Return the errors along a log, a `STEP` apart from its beginning."""
    every = round(STEP / log.step)
    states = np.concatenate((log.position, log.velocity, log.attitude, log.body_rate), axis=-1)[::every]
    odometry = Odometry(case.estimates, states.shape[1], len(states), STEP, random)
    steps = [odometry.advance(*now) for now in zip(states, log.specific_force[::every], strict=True)]
    return _stacked(steps)


def joined(steps: list[Errors], run: int) -> Errors:
    """Return the errors of one run along its flight, (steps, 1, 3), from those of all runs, step by step."""
    return _stacked([Errors(*(part[run : run + 1] for part in vars(step).values())) for step in steps])


def _stacked(steps: list[Errors]) -> Errors:
    return Errors(*(np.stack(parts) for parts in zip(*(vars(step).values() for step in steps), strict=True)))


def believed(log: Log, run: int, times: Array, errors: Errors) -> dict[str, Array]:
    """Return the `estimate_*` columns of a run, (samples,) each.

    Args:
        log: what truly happened.
        run: which of the flights.
        times: of the samples, s.
        errors: along the log, a `STEP` apart.
    """
    names = ("position", "velocity", "attitude", "body_rate")
    truth = [at(getattr(log, name)[:, run], times - DELAY, log.step, log.before) for name in names]
    wrong = Errors(*(at(part[:, run], times, STEP, log.before) for part in vars(errors).values()))
    belief = believed_state(np.concatenate(truth, axis=-1), wrong)
    belief[:, 6:10] *= np.where(belief[:, 6:7] < 0, -1.0, 1.0)
    columns = [
        f"estimate_{name}_{axis}" for name in names for axis in ("wxyz" if name == "attitude" else "xyz")
    ]
    return dict(zip(columns, belief.T, strict=True))
