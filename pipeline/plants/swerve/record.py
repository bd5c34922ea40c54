"""Recording of a swerve case with a sealed answer key."""

from typing import Any

import numpy as np

from simgap.plants.sealing import sealed
from simgap.plants.swerve.case import SwerveCase
from simgap.plants.swerve.motion import SETTLING, STEP, move
from simgap.plants.swerve.reference import names, references
from simgap.plants.swerve.sensing import record
from simgap.plants.swerve.truth import answer_key
from simgap.platforms import Swerve
from simgap.recordings.recording import Recording


def record_swerve(case: SwerveCase, platform: Swerve, seed: int) -> tuple[Recording, dict[str, Any]]:
    """Record drives of the robot that a case conceals; see `simgap.plants.record_case`.

    Raises:
        InputError: when the case cannot be driven.
    """
    case.check()
    effects, outside = case.concealed(platform)
    steps = round((SETTLING + case.duration) / STEP) + 1
    times = np.arange(steps, dtype=np.float64) * STEP - SETTLING
    reference = references(case, platform, times, np.random.default_rng([seed, 0]))
    log = move(effects, outside, platform, case, reference, np.random.default_rng([seed, 1]))
    offset = effects.get("sensor_time_offset@chassis", "offset")
    key = answer_key(effects, outside, platform)
    return sealed(record(log, case, offset, names(case), [seed, 2]), "swerve", key), key
