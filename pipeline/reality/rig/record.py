"""Turn a case of a concealed rig and seal its answer."""

from typing import Any

import numpy as np
import pandas as pd

from pipeline.platforms import Quadrotor
from pipeline.reality.battery import Battery
from pipeline.reality.design import design
from pipeline.reality.flight import SETTLING, STEP
from pipeline.reality.rig.case import RigCase
from pipeline.reality.rig.motion import turn
from pipeline.reality.rotation import Array
from pipeline.reality.sampling import held_at
from pipeline.reality.sealing import sealed
from pipeline.reality.sensing import record
from pipeline.reality.truth import answer_key
from pipeline.recordings.recording import Recording


def record_rig(case: RigCase, platform: Quadrotor, seed: int) -> tuple[Recording, dict[str, Any]]:
    """Record runs of the rig that a case conceals; see `pipeline.reality.record_case`.

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
