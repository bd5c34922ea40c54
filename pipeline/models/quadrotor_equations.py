"""A quadrotor's equations of motion in weak form, as linear regressions on squared rotor speeds or commands.

Newton along body z:   d(v_z)/dt + (ω × v)_z − (Rᵀg)_z = (k_F/m)·Σ n² + …
Euler about each axis: d(ω_i)/dt = Σ (torque of n² per coefficient)/J_i + …

What is commonly left out of these equations is fitted alongside, so that it does not distort the rotors'
coefficients: inflow and translational lift; a centre of mass off its place, damping, blade flapping,
gyroscopic terms, rotor inertia.
Source: Mahony, Kumar & Corke 2012, "Multirotor aerial vehicles", IEEE Robotics & Automation Magazine 19(3).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from scipy.spatial.transform import Rotation

from simgap.errors import InputError
from simgap.models.regression import Table, join
from simgap.models.segments import Segment, segments
from simgap.physics.weak_form import (
    MovingWindow,
    moving_centres,
    moving_mean_of,
    moving_mean_rate_of,
    moving_window,
)
from simgap.platforms import Quadrotor
from simgap.recordings.recording import Recording

EQUATIONS = ("thrust", "roll", "pitch", "yaw")


@dataclass(frozen=True)
class Motion:
    """Signals: rotor speed or command (n, 4), body velocity, gravity and rate (n, 3), time (n,)."""

    rotor: np.ndarray
    velocity: np.ndarray
    gravity: np.ndarray
    rate: np.ndarray
    time: np.ndarray


def quadrotor_tables(
    recording: Recording,
    platform: Quadrotor,
    runs: Sequence[str],
    stem: str,
    window: float,
    block_duration: float,
) -> dict[str, Table]:
    """Return the regression of each equation; its first regressor is that of the rotors.

    Args:
        recording: cleaned.
        platform: geometry and gravity.
        runs: to take samples from.
        stem: motor_speed or motor_command.
        window: width of the test functions, s.
        block_duration: of the blocks that standard errors leave out, s.

    Raises:
        InputError: when no segment is as long as a window.
    """
    function = moving_window(window, recording.time_step)
    pieces: dict[str, list[tuple[np.ndarray, np.ndarray, np.ndarray]]] = {name: [] for name in EQUATIONS}
    first = 0
    for segment in segments(recording, runs):
        if len(segment.frame) < len(function.weights):
            continue
        motion = _motion(segment, stem, platform)
        centres = motion.time[moving_centres(function, len(motion.time)).numpy()]
        block = first + ((centres - centres[0]) / block_duration).astype(int)
        first = int(block[-1]) + 1
        for name, (regressors, target) in _equations(motion, function, platform).items():
            pieces[name].append((regressors, target, block))
    if not first:
        raise InputError("no segment is as long as a window", "sysid.window", "shorten it, or record longer")
    return {name: join(parts) for name, parts in pieces.items()}


def _motion(segment: Segment, stem: str, platform: Quadrotor) -> Motion:
    attitude = Rotation.from_quat(segment.columns([f"attitude_{axis}" for axis in "wxyz"]), scalar_first=True)
    velocity = segment.columns([f"velocity_{axis}" for axis in "xyz"])
    down = np.tile([0.0, 0.0, -platform.gravity], (len(velocity), 1))
    return Motion(
        rotor=segment.columns([f"{stem}_{number}" for number in range(1, 5)]),
        velocity=attitude.apply(velocity, inverse=True),
        gravity=attitude.apply(down, inverse=True),
        rate=segment.columns([f"body_rate_{axis}" for axis in "xyz"]),
        time=segment.columns(["t"])[:, 0],
    )


def _equations(
    motion: Motion, function: MovingWindow, platform: Quadrotor
) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return regressors (windows, terms) and target (windows,) of each equation, the rotors' term first."""
    squared, (p, q, r) = motion.rotor**2, motion.rate.T
    positions, directions = np.array(platform.rotor_positions), np.array(platform.rotor_directions)
    total = motion.rotor.sum(1)
    spin = motion.rotor @ directions
    thrust = squared.sum(1)
    x, y, z = motion.velocity.T
    inertial = motion.gravity[:, 2] - np.cross(motion.rate, motion.velocity)[:, 2]
    nuisances = {
        "thrust": [total * z, total * np.hypot(x, y)],
        "roll": [thrust, p, total * y, q * r, q * spin],
        "pitch": [thrust, q, total * x, p * r, p * spin],
        "yaw": [thrust, r, p * q],
    }
    rotors = {
        "thrust": thrust,
        "roll": squared @ positions[:, 1],
        "pitch": -squared @ positions[:, 0],
        "yaw": squared @ directions,
    }
    rates = {"thrust": z, "roll": p, "pitch": q, "yaw": r}
    equations = {}
    for name in EQUATIONS:
        series = torch.from_numpy(np.stack([rotors[name], *nuisances[name], inertial, rates[name], spin]))
        *columns, apparent = moving_mean_of(function, series[:-2]).numpy()
        target, rotor_rate = moving_mean_rate_of(function, series[-2:]).numpy()
        if name == "thrust":
            target = target - apparent
        if name == "yaw":
            columns.append(rotor_rate)
        equations[name] = (np.column_stack(columns), target)
    return equations
