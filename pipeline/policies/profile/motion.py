"""Motion of a drive: time, position, velocity and voltages."""

from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor

from simgap.policies.profile.drive import Drive
from simgap.policies.profile.driven import VELOCITY, Driven, LinearDrive
from simgap.policies.profile.reference import Array


@dataclass(frozen=True)
class Motion:
    """A motion along a line, evenly sampled.

    Attributes:
        period: between two samples, s.
        position: (samples,) m.
        velocity: (samples,) m/s.
        voltage: by wheel, held from its sample to the next, (samples - 1, wheels) V.
    """

    period: float
    position: Array
    velocity: Array
    voltage: Array

    @property
    def time(self) -> Array:
        """Of each sample, s."""
        return self.period * np.arange(len(self.position), dtype=np.float64)

    def arrival(self, target: float, tolerance: float, speed_tolerance: float) -> float:
        """Return from when on the target is kept to, s; NaN where it never is.

        Args:
            target: m.
            tolerance: of the position, m.
            speed_tolerance: m/s.
        """
        there = np.abs(self.position - target) <= tolerance
        there &= np.abs(self.velocity) < speed_tolerance
        away = np.flatnonzero(~there)
        first = 0 if len(away) == 0 else int(away[-1]) + 1
        return float(self.time[first]) if first < len(there) else float("nan")


def drive_along(drive: Drive, desired: Array, period: float, driven: Driven | None = None) -> Motion:
    """Return what a drive at rest does when its feedforward is asked for velocities, as far as its limits let it.

    Args:
        drive: identified, for the feedforward and the limits.
        desired: wanted at the end of each period, (steps,) m/s.
        period: s.
        driven: what moves; None: the identified drive itself.
    """
    driven = driven or LinearDrive(drive)
    state = driven.begin(torch.zeros_like(drive.speed)[None])
    voltages = []
    for wanted in torch.from_numpy(desired).to(drive.speed):
        velocity = state[VELOCITY]
        asked = drive.feedforward(velocity, wanted.expand_as(velocity), period)
        applied = drive.within_limits(velocity, asked)
        state, _ = driven.advance(state, applied, period)
        voltages.append(applied[0])
    return drive_open_loop(drive, torch.stack(voltages), period, driven)


def drive_open_loop(drive: Drive, voltage: Tensor, period: float, driven: Driven | None = None) -> Motion:
    """Return what a drive at rest does under voltages; it is where its wheels are on average.

    Args:
        drive: identified.
        voltage: by wheel, within the limit, (steps, wheels) V.
        period: for which each is held, s.
        driven: what moves; None: the identified drive itself.
    """
    driven = driven or LinearDrive(drive)
    state = driven.begin(torch.zeros_like(drive.speed)[None])
    position = torch.zeros_like(drive.speed)
    rows = [torch.stack([position, state[VELOCITY][0]])]
    for applied in voltage:
        state, made = driven.advance(state, applied[None], period)
        position = position + made[0]
        rows.append(torch.stack([position, state[VELOCITY][0]]))
    path = torch.stack(rows).double().mean(-1).numpy()
    return Motion(period, path[:, 0], path[:, 1], voltage.double().numpy())
