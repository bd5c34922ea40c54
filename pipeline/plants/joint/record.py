"""Recording of a joint case with a sealed answer key."""

from typing import Any

import numpy as np

from simgap.plants.joint.case import JointCase
from simgap.plants.joint.motion import SETTLING, STEP, move
from simgap.plants.joint.reference import names, references
from simgap.plants.joint.sensing import SensorTiming, record
from simgap.plants.joint.truth import Answered, answer_key
from simgap.plants.sealing import sealed
from simgap.platforms import Joint
from simgap.recordings.recording import Recording


def record_joint(case: JointCase, platform: Joint, seed: int) -> tuple[Recording, dict[str, Any]]:
    """Record runs of the joint that a case conceals; see `simgap.plants.record_case`.

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
    timing = SensorTiming(
        effects.get("sensor_time_offset", "offset"), effects.get("velocity_filter", "time_constant")
    )
    frame = record(log, platform, case, timing, names(case), [seed, 2])
    key = answer_key(outside, Answered(effects, platform, case, log))
    return sealed(frame, "joint", key, sliding=case.sliding), key
