"""Outputs of one kind taken together: the mean and the variance of their scores."""

import re
from collections.abc import Mapping

import numpy as np

_ONE_OF_SEVERAL = re.compile(r"(?P<group>.+)_(?:\d+|[xyz])")  # steer_velocity_1, body_rate_x


def group_scores(scores: Mapping[str, Mapping[str, float]]) -> dict[str, dict[str, dict[str, float]]]:
    """Return mean and variance of each score over the outputs of a group, such as the motors of a swerve drive.

    Outputs whose names differ in their last number or axis alone are a group. A single output is none.

    Args:
        scores: output to scores by name, the same names in all outputs of a group.

    Returns:
        Group to {mean, variance} to scores by name. The variance is the mean squared deviation from the mean, in the
        score's unit squared. NaN where the score of an output is.
    """
    members: dict[str, list[Mapping[str, float]]] = {}
    for output, own in scores.items():
        if match := _ONE_OF_SEVERAL.fullmatch(output):
            members.setdefault(match["group"], []).append(own)
    return {
        group: {
            "mean": {name: float(np.mean([one[name] for one in own])) for name in own[0]},
            "variance": {name: float(np.var([one[name] for one in own])) for name in own[0]},
        }
        for group, own in members.items()
        if len(own) > 1
    }
