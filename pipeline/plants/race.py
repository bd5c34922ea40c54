"""Races of the concealed plant under external control: thrust and body rates in, state and estimate out."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from simgap.plants.battery import Battery
from simgap.plants.case import PlantCase
from simgap.plants.design import design
from simgap.plants.estimator import DELAY, Aid, Errors, Odometry, believed, believed_state, joined
from simgap.plants.estimator import STEP as ESTIMATED_EVERY
from simgap.plants.flight import STEP, Log, Machines, log_of
from simgap.plants.rotation import Array
from simgap.plants.sampling import held_at
from simgap.plants.sensing import record
from simgap.platforms import Quadrotor
from simgap.recordings.contract import channel_units
from simgap.recordings.recording import Recording

Regulator = Callable[[Array, Array], Array]
"""From body rates (runs, 3), rad/s, and a reference (runs, 4), m/s² and rad/s, to rotor speeds (runs, 4), rad/s."""

Mask = NDArray[np.bool_]

_ESTIMATE_STEPS = round(ESTIMATED_EVERY / STEP)
_DELAY_STEPS = round(DELAY / STEP)
_REFERENCE = ("thrust_command", *(f"body_rate_command_{axis}" for axis in "xyz"))


class RacedMachines:
    """The concealed machine as often as there are runs, each with its own charge, gyro noise, air and estimator.

    Attributes:
        runs: how many.
        step: of the plant and its rate controller, s.
    """

    step = STEP

    def __init__(
        self,
        case: PlantCase,
        platform: Quadrotor,
        regulate: Regulator,
        runs: int,
        seconds: float,
        seed: int,
        logged: int = 0,
        aid: Aid | None = None,
    ) -> None:
        """Put them together.

        Args:
            case: what is concealed.
            platform: what the world is told of the machine.
            regulate: the flight controller's rate loop, asked at every step.
            runs: how many.
            seconds: for which they fly at most.
            seed: of every random draw.
            logged: how many of the runs, the first ones, can be recorded.
            aid: against the drift of the estimators; None: it is forgotten by itself.

        Raises:
            InputError: when the case cannot be flown.
        """
        case.check()
        for_plant, for_charge, for_belief, self._for_sensors = (
            np.random.default_rng([seed, part]) for part in range(4)
        )
        lowest, highest = case.charge
        self._charge = for_charge.uniform(lowest, highest, runs)
        battery = Battery(platform, self._charge, case.battery_wear)
        self.runs, self._regulate, self._case, self._platform = runs, regulate, case, platform
        steps = round(seconds / STEP) + 1
        flown = replace(case, runs=runs)
        self._machines = Machines(design(platform, case), platform, flown, battery, for_plant, steps)
        self._odometry = Odometry(
            case.estimates, runs, steps // _ESTIMATE_STEPS + 1, ESTIMATED_EVERY, for_belief, aid
        )
        self._looks = aid is not None and (aid.look or aid.sight) is not None
        self._estimates = list[tuple[Mask, Array, dict[str, NDArray[np.int_]]]]()
        self._log = _Logbook(logged)

    def fly(self, state: Array, reference: Array, period: float) -> tuple[Array, Array]:
        """Return where a command leads, and where the machines believe that they are, (runs, 13) each.

        They know it exactly where the case has no estimator.

        Args:
            state: position, velocity (world), attitude, body rate, (runs, 13).
            reference: collective thrust over mass and body rates, held for the period, (runs, 4) m/s² and rad/s.
            period: s.
        """
        machines, passed = self._machines, []
        machines.state = np.array(state, dtype=np.float64)
        for _ in range(round(period / STEP)):
            happened = machines.advance(self._regulate(machines.felt_rate(), reference))
            passed.append(happened[0])
            self._note(happened, reference)
        error = np.linalg.norm(self._errors.position, axis=-1)
        self._estimates.append((self._odometry.in_view, error, self._odometry.counts))
        late = [*passed, machines.state][-1 - _DELAY_STEPS :][0]
        belief = believed_state(late, self._errors) if self._case.estimates > 0 else machines.state
        return machines.state, belief

    def _note(self, happened: tuple[Array, ...], reference: Array) -> None:
        """Write down a step, and go on with the estimators where it is time."""
        if self._log.steps % _ESTIMATE_STEPS == 0:
            self._errors = self._odometry.advance(happened[0], happened[1])
            self._log.errors.append(self._errors)
        self._log.note(happened, reference)

    def estimates(self, flying: Mask) -> dict[str, float]:
        """Return the RMS error of the estimated position, m, and if they look for gates, the share of time with one.

        Of cameras whose images are read, there is also what was counted in flight.

        Args:
            flying: which runs were in flight at each call of `fly`, (calls, runs) bool.
        """
        views, errors, counts = zip(*self._estimates, strict=True)
        in_view, error = np.stack(views)[flying], np.stack(errors)[flying]
        measures = {"position_error": float(np.sqrt((error**2).mean()))}
        seen = {"gate_in_view": float(in_view.mean())} if self._looks else {}
        grown = {name: np.stack([each[name] for each in counts]) for name in counts[0]}
        counted = {
            name: float(np.diff(each, axis=0, prepend=0)[flying].sum()) for name, each in grown.items()
        }
        return measures | seen | counted

    def recording(self, seconds: Array) -> Recording:
        """Return what the sensors of the logged runs recorded.

        Args:
            seconds: for which each of them flew, (logged,).
        """
        random, frames = self._for_sensors, []
        for run, duration in enumerate(seconds):
            log, reference = self._log.of(run)
            case = replace(self._case, duration=float(duration), runs=1, estimates=0.0)
            frame = record(
                log, self._platform, case, (f"race_{run + 1}",), self._charge[run : run + 1], random
            )
            times = frame["t"].to_numpy()
            frame = frame.assign(**dict(zip(_REFERENCE, held_at(reference, times, STEP, 0.0).T, strict=True)))
            if self._case.estimates > 0:
                frame = frame.assign(**believed(log, 0, times, joined(self._log.errors, run)))
            frames.append(frame)
        frame = pd.concat(frames, ignore_index=True)
        units = channel_units("quadrotor")
        known = {column: units[column] for column in frame.columns if column in units}
        return Recording(frame=frame, kind="quadrotor", units=known, source="races of the concealed plant")


class _Logbook:
    """What happened to the first runs, step by step, and what their estimators got wrong."""

    def __init__(self, runs: int) -> None:
        self.runs, self.steps = runs, 0
        self.errors: list[Errors] = []
        self._kept: list[tuple[Array, ...]] = []
        self._reference: list[Array] = []

    def note(self, happened: tuple[Array, ...], reference: Array) -> None:
        self.steps += 1
        if self.runs:
            self._kept.append(tuple(part[: self.runs].copy() for part in happened))
            self._reference.append(reference[: self.runs].copy())

    def of(self, run: int) -> tuple[Log, Array]:
        """Return the log of one run and its reference (steps, 4)."""
        kept = [tuple(part[run : run + 1] for part in step) for step in self._kept]
        return log_of(kept, STEP, before=0.0), np.stack(self._reference)[:, run]
