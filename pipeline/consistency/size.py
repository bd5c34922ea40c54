"""Rates that are as large as no unit explains: a warning, where the check finds neither agreement nor a cause."""

from collections.abc import Iterator

import numpy as np

from simgap.consistency.gearing import UNUSUAL
from simgap.consistency.kinematics import position_pairs
from simgap.consistency.redundancy import agreement_of
from simgap.consistency.samples import samples_of
from simgap.recordings.cleaning.clean import mended
from simgap.recordings.recording import Recording

_RATE = {"joint": "velocity", "swerve": "steer_velocity_1", "quadrotor": "velocity_x"}
_ALIKE = 0.95  # correlation: both show the same motion


def size_doubts(recording: Recording) -> Iterator[str]:
    """Yield a sentence for each rate that follows its position, but is a quarter larger or smaller than its change.

    Args:
        recording: raw or cleaned, without a contradiction.
    """
    samples = samples_of(recording if recording.cleaned else mended(recording))
    if _RATE[samples.kind] not in samples:
        return
    for pair in position_pairs(samples):
        found = agreement_of(pair)
        if found and found.alike > _ALIKE and abs(np.log(found.ratio)) > UNUSUAL:
            rate, position = found.columns
            yield (
                f"{rate!r} is {found.ratio:.3g} times as large as the rate of change of {position!r} (correlation "
                f"{found.alike:.2f}), which no unit explains: check the scale of both before you believe a wrong "
                "number or friction."
            )
