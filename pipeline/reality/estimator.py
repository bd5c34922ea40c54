"""What the machine itself believed: an on-board estimator that drifts and is a little late."""

import numpy as np

from pipeline.reality.case import PlantCase
from pipeline.reality.flight import SETTLING, Log
from pipeline.reality.rotation import Array, from_small_angles, product
from pipeline.reality.sampling import at
from pipeline.reality.wind import first_order_noise

_DELAY = 0.008  # s
_FORGETS = 2.0  # s, correlation time of its errors
_ERRORS = {"position": 0.05, "attitude": 0.015, "velocity": 0.08, "body_rate": 0.02}
"""Standard deviations at a scale of 1: m, rad about each body axis, m/s, rad/s."""


def believed(
    log: Log, run: int, times: Array, case: PlantCase, random: np.random.Generator
) -> dict[str, Array]:
    """Return the `estimate_*` columns of a run, (samples,) each.

    Args:
        log: what truly happened.
        run: which of the flights.
        times: of the samples, s.
        case: scale of the errors, and the rate.
        random: of the errors.
    """
    columns: dict[str, Array] = {}
    for name, size in _ERRORS.items():
        truth = at(getattr(log, name)[:, run], times - _DELAY, log.step, SETTLING)
        step = 1.0 / (case.rate * _FORGETS)
        error = case.estimates * size * first_order_noise((len(times), 3), step, random)
        if name == "attitude":
            values, axes = product(truth, from_small_angles(error)), "wxyz"
            values = np.where(values[:, :1] < 0, -values, values)
            values /= np.linalg.norm(values, axis=-1, keepdims=True)
        else:
            values, axes = truth + error, "xyz"
        columns |= {f"estimate_{name}_{axis}": values[:, index] for index, axis in enumerate(axes)}
    return columns
