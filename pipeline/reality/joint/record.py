"""Run a case of a concealed joint and seal its answer."""

from typing import Any

import numpy as np

from pipeline.platforms import Joint
from pipeline.reality.joint.case import JointCase
from pipeline.reality.joint.motion import SETTLING, STEP, move
from pipeline.reality.joint.reference import names, references
from pipeline.reality.joint.sensing import record
from pipeline.reality.joint.truth import Answered, answer_key
from pipeline.reality.sealing import sealed
from pipeline.recordings.recording import Recording


def record_joint(case: JointCase, platform: Joint, seed: int) -> tuple[Recording, dict[str, Any]]:
    """Record runs of the joint that a case conceals; see `pipeline.reality.record_case`.

    Raises:
        InputError: when the case cannot be run.
    """
    case.check()
    case.check_machine(platform)
    effects, outside = case.concealed(platform)
    steps = round((SETTLING + case.duration) / STEP) + 1
    times = np.arange(steps, dtype=np.float64) * STEP - SETTLING
    reference = references(case, times, np.random.default_rng([seed, 0]))
    log = move(effects, outside, platform, case, reference, np.random.default_rng([seed, 1]))
    offset = effects.get("sensor_time_offset", "offset")
    frame = record(log, platform, case, offset, names(case), [seed, 2])
    key = answer_key(outside, Answered(effects, platform, case, log))
    return sealed(frame, "joint", key, sliding=case.sliding), key
