"""Grey-box laws of the literature beside the named effects: python -m benchmarks.grey_box [BRANCH ...]

First: simgap reproduce BRANCH. Each law takes the place of the forces and torques that the diagnosis of the branch has
named. Numbers of the platform and delays that it has named stay. All are fitted together to the flights that the
diagnosis fitted, and judged on those that it held out. The tables are those of docs/models.md.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from benchmarks.page import table
from simgap.diagnosis.validate import validate
from simgap.effects import Effect, effect_by_key
from simgap.equations.fit import Fit, fit
from simgap.equations.refit import extend
from simgap.equations.residuals import channels_on
from simgap.gap.reading import Reading, likeliest_reading
from simgap.gap.settings import BELIEVED, Gap
from simgap.recordings.recording import read_recording
from simgap.simulation.storage import read_simulator

BRANCHES = ("nanodrone", "nanobench")
BODY = ("force", "torque")
LAWS = {
    "polynomial (Kaufmann et al. 2023)": ("grey_box_aerodynamics",),
    "rotors with inflow (Kantue & Pedro)": ("inflow_ratio",),
    "rotors with flapping (Kantue & Pedro)": ("tip_path_plane_flapping",),
    "rotors with inflow and flapping": ("inflow_ratio", "tip_path_plane_flapping"),
}


def laws_of(named: Sequence[Effect]) -> Iterator[tuple[str, list[Effect]]]:
    """Yield each law's name and effects."""
    kept = [effect for effect in named if effect.acts_on not in BODY]
    yield "numbers of the platform and delays", kept
    yield "named effects", list(named)
    for name, keys in LAWS.items():
        yield name, [*kept, *(effect_by_key("quadrotor", key) for key in keys)]


def fitted(effects: Sequence[Effect], reading: Reading) -> Fit:
    """Return the fit of all effects together, each from where it fits best beside those before it."""
    found = fit(reading.nominal, reading.problem)
    for effect in effects:
        extended = extend(found, effect, reading.problem, reading.starts)
        found = fit(extended.simulator, reading.problem)
    return found


def rows_of(branch: str) -> Iterator[list[str]]:
    """Yield the rows of a branch's table."""
    folder = Path("artifacts") / branch
    recording = read_recording(folder / "clean" / "recording.parquet")
    answer = json.loads((folder / "diagnose" / "diagnosis.json").read_text())
    believed = [each["name"] for each in answer["effects"] if each["probability"] >= BELIEVED]
    named = [effect_by_key("quadrotor", name) for name in believed]
    reading = likeliest_reading(recording, read_simulator(folder / "build_sim"), Gap())
    prepared = reading.prepared
    channels = channels_on(prepared.nominal, prepared.proving)
    body = [index for index, channel in enumerate(channels) if channel.name.startswith(BODY)]
    for name, effects in laws_of(named):
        simulator = fitted(effects, reading).simulator
        functions, counted = prepared.problem.functions, list(channels)
        found = validate(
            prepared.nominal, simulator, prepared.proving, functions, counted, prepared.held_out, 1
        )
        before, after, _ = found.channels[body].T
        count = sum(len(effect.parameters) for effect in effects)
        yield [name, str(count), *(f"{share:.0%}" for share in (after / before).tolist())]


def main(branches: Sequence[str]) -> None:
    """Print a table for each branch."""
    for branch in branches:
        if not (Path("artifacts") / branch / "diagnose" / "diagnosis.json").is_file():
            sys.exit(f"grey_box: {branch}: there is no diagnosis; run simgap reproduce {branch} first")
        rows = list(rows_of(branch))
        axes = ("x", "y", "z")
        head = [
            branch,
            "coefficients",
            *(f"force {axis}" for axis in axes),
            *(f"torque {axis}" for axis in axes),
        ]
        print(table(head, rows))


if __name__ == "__main__":
    main(sys.argv[1:] or BRANCHES)
