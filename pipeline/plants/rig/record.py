"""Recording of a rig case with a sealed answer key."""

from typing import Any

import numpy as np
import pandas as pd

from simgap.plants.battery import Battery
from simgap.plants.design import design
from simgap.plants.flight import SETTLING, STEP
from simgap.plants.rig.case import RigCase
from simgap.plants.rig.motion import turn
from simgap.plants.rotation import Array
from simgap.plants.sampling import held_at
from simgap.plants.sealing import sealed
from simgap.plants.sensing import record
from simgap.plants.truth import answer_key
from simgap.platforms import Quadrotor
from simgap.recordings.recording import Recording


def record_rig(case: RigCase, platform: Quadrotor, seed: int) -> tuple[Recording, dict[str, Any]]:
    """Record runs of the rig that a case conceals; see `simgap.plants.record_case`.

    Raises:
        InputError: when the case cannot be run.
    """
    case.check()
    plant, names = case.plant, tuple(f"rig_{run}" for run in range(1, case.runs + 1))
    for_pilot, for_plant, for_sensors = (np.random.default_rng([seed, part]) for part in range(3))
    charge = for_sensors.uniform(plant.charge[0], plant.charge[1], case.runs)
    airframe, battery = design(platform, plant), Battery(platform, charge)
    log, commands = turn(case, airframe, platform, battery, [for_pilot, for_plant])
    key = answer_key(airframe, platform, plant, log)
    key["outside"] = case.outside()
    frame = record(log, platform, plant, names, charge, for_sensors)
    return sealed(_with_commands(frame, names, commands), "quadrotor", key), key


def _with_commands(frame: pd.DataFrame, names: tuple[str, ...], commands: Array) -> pd.DataFrame:
    """Add the commanded body rates (steps, runs, 3), rad/s, at the samples that were kept."""
    pieces = []
    for run, name in enumerate(names):
        piece = frame[frame["run"] == name].copy()
        given = held_at(commands[:, run], piece["t"].to_numpy(copy=True), STEP, SETTLING)
        for axis, values in zip("xyz", given.T, strict=True):
            piece[f"body_rate_command_{axis}"] = values
        pieces.append(piece)
    return pd.concat(pieces, ignore_index=True)
