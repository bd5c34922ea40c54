"""What an on-board estimate gets wrong, as a function of where and how the machine flies."""

from typing import NamedTuple

import numpy as np
import pandas as pd
import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.physics import rotations
from simgap.policies.residual.wander import Course
from simgap.recordings.excerpt import evenly

FEATURES = 15
"""Position (3), velocity (3), first two columns of the rotation matrix (6), body rate (3)."""

RESIDUALS = tuple(f"{name}_{axis}" for name in ("position", "velocity", "tilt") for axis in "xyz")
"""Estimate less truth: m, m/s (world frame), and the rotation from true to estimated attitude about body axes, rad."""

_ESTIMATED = {"position": "xyz", "attitude": "wxyz", "velocity": "xyz"}
_STATE_AXES = {**_ESTIMATED, "body_rate": "xyz"}


def state_features(state: dict[str, Tensor]) -> Tensor:
    """Return what the residuals depend on, (batch, 15).

    The attitude stands as two columns of its matrix, since quaternions jump (Zhou et al. 2019, arXiv 1812.07035).

    Args:
        state: `position`, `attitude`, `velocity` (world) and `body_rate`, each (batch, ...).
    """
    turn = rotations.to_matrix(state["attitude"])
    columns = turn[..., :2].transpose(-1, -2).flatten(-2)
    return torch.cat([state["position"], state["velocity"], columns, state["body_rate"]], dim=-1)


def misjudged(truth: dict[str, Tensor], belief: dict[str, Tensor]) -> Tensor:
    """Return the residuals of beliefs about states, (batch, 9), in the order of `RESIDUALS`."""
    turn = rotations.multiply(rotations.conjugate(truth["attitude"]), belief["attitude"])
    return torch.cat(
        [
            belief["position"] - truth["position"],
            belief["velocity"] - truth["velocity"],
            rotations.to_rotation_vector(turn),
        ],
        dim=-1,
    )


def with_residual(state: dict[str, Tensor], residual: Tensor) -> dict[str, Tensor]:
    """Return what is believed of states, given residuals (batch, 9); body rates are believed as they are."""
    position, velocity, tilt = residual.split(3, dim=-1)
    attitude = rotations.multiply(state["attitude"], rotations.from_rotation_vector(tilt))
    return {
        **state,
        "position": state["position"] + position,
        "velocity": state["velocity"] + velocity,
        "attitude": rotations.normalize(attitude),
    }


class Beliefs(NamedTuple):
    """What was believed along recorded flights, float64.

    Attributes:
        features: of the true states, (samples, 15).
        residual: (samples, 9).
        course: when the samples were taken.
    """

    features: Tensor
    residual: Tensor
    course: Course


def recorded_beliefs(frame: pd.DataFrame, samples: int) -> Beliefs:
    """Return what was believed, evenly over a recording.

    Args:
        frame: of a recording with `estimate_*` columns.
        samples: at most.

    Raises:
        InputError: when the recording has no estimates, or hardly any.
    """
    own, believed = _columns("", _STATE_AXES), _columns("estimate_", _ESTIMATED)
    missing = [column for column in believed if column not in frame]
    if missing:
        raise InputError(
            f"has no column {missing[0]}",
            "recording",
            "record what the machine believed, or residual.observation.enabled=false",
        )
    complete = frame[["run", "t", *own, *believed]].dropna()
    if len(complete) < FEATURES:
        raise InputError(f"has {len(complete)} samples with an estimate", "recording", "record more")
    chosen = complete.iloc[evenly(len(complete), samples)]
    truth, belief = _state(chosen[own], _STATE_AXES), _state(chosen[believed], _ESTIMATED)
    return Beliefs(state_features(truth), misjudged(truth, belief), _course(chosen))


def _course(frame: pd.DataFrame) -> Course:
    flight, _ = pd.factorize(frame["run"])
    moment = frame["t"] - frame.groupby("run", sort=False)["t"].transform("first")
    return Course(torch.from_numpy(flight), torch.tensor(moment.to_numpy(dtype=np.float64)))


def _columns(stem: str, parts: dict[str, str]) -> list[str]:
    return [f"{stem}{name}_{axis}" for name, axes in parts.items() for axis in axes]


def _state(frame: pd.DataFrame, parts: dict[str, str]) -> dict[str, Tensor]:
    values = torch.tensor(frame.to_numpy(dtype=np.float64))
    return dict(zip(parts, values.split([len(axes) for axes in parts.values()], dim=-1), strict=True))
