"""Recording of a quadrotor case with a sealed answer key."""

from typing import Any

import numpy as np

from simgap.plants.battery import Battery
from simgap.plants.case import PlantCase
from simgap.plants.design import design
from simgap.plants.dither import shake
from simgap.plants.flight import fly_paths
from simgap.plants.path import plan
from simgap.plants.sealing import sealed
from simgap.plants.sensing import record
from simgap.plants.truth import answer_key
from simgap.platforms import Quadrotor
from simgap.recordings.recording import Recording


def fly(case: PlantCase, platform: Quadrotor, seed: int) -> tuple[Recording, dict[str, Any]]:
    """Record flights of the plant that a case conceals.

    Two cases with one seed fly the same paths with the same noise: they differ by their effects alone.

    Args:
        case: what is concealed and how it is recorded.
        platform: what the world is told of the plant.
        seed: of every random draw.

    Returns:
        The recording, whose `source` names the hash of the key, and the key.

    Raises:
        InputError: when the case cannot be flown.
    """
    case.check()
    for_paths, for_plant, for_sensors = (np.random.default_rng([seed, part]) for part in range(3))
    airframe = design(platform, case)
    paths, dither = plan(case, for_paths), shake(case, for_paths)
    lowest, highest = case.charge
    charge = for_sensors.uniform(lowest, highest, case.runs)
    battery = Battery(platform, charge, case.battery_wear)
    log = fly_paths(airframe, platform, case, paths, dither, battery, for_plant)
    key = answer_key(airframe, platform, case, log)
    frame = record(log, platform, case, paths.names, charge, for_sensors)
    return sealed(frame, "quadrotor", key), key
