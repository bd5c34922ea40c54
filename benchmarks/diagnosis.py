"""Processor time of diagnoses: python -m benchmarks.diagnosis --results RESULTS --output PAGE.

`RESULTS` are of `simgap prove`, which notes the processor time of each concealed case. How that time grows is measured
here, on a joint with friction.
"""

import argparse
import json
import os
import resource
import statistics
import time
from collections.abc import Iterator
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import torch

from benchmarks.page import machine, table
from simgap.diagnosis.diagnose import diagnose
from simgap.effects import effect_by_key, effects_of
from simgap.gap.settings import Gap
from simgap.platforms import Joint, JointMotor
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.rollout import step

TIME_STEP = 5e-3  # s
RUN = 10.0  # s
SECONDS = (40.0, 80.0, 160.0, 320.0)
SHARES = (0.25, 0.5, 1.0)
BARS = {"joint": 5.0, "quadrotor": 10.0, "swerve": 20.0}  # s of processor time for the median case
WORST = 60.0  # s
JOINT = Joint(inertia=0.05, motor=JointMotor(resistance=1.0, torque_constant=0.05, gear_ratio=10.0))

_PAGE = """# Speed of a diagnosis

Made by `{command}` on {day}. {machine}

Times are processor time of one thread: cleaning, simulator and diagnosis with its figures. The recording is not
included.

## Concealed cases

Seed {seed}, {cases} cases. The targets are for the median case of a kind; no case may take more than {worst:.0f} s.

{kinds}
## Growth

The same joint with dry and viscous friction, at 200 Hz, median of {rounds} rounds. All blocks are fitted here; by
default 200 of them are at most (`gap.most_blocks`), which bounds the time. Greatest memory of the process: {memory:.2f}
GiB.

{samples}
The whole catalogue has {catalogue} entries, some of them of one effect in several places. Of {longest:.0f} s of
recording:

{effects}
"""


def recording_of(seconds: float) -> Recording:
    """Return a recording of a joint with friction, driven by steps of its voltage."""
    random = np.random.default_rng(0)
    runs, samples = round(seconds / RUN), round(RUN / TIME_STEP)
    plant = Simulator(
        JOINT,
        (
            FittedEffect(effect_by_key("joint", "coulomb_friction"), {"level": 0.3}),
            FittedEffect(effect_by_key("joint", "viscous_friction"), {"coefficient": 0.05}),
        ),
    )
    voltage = torch.from_numpy(np.repeat(random.uniform(-8.0, 8.0, (runs, samples // 80)), 80, axis=1))
    state, states, memory = torch.zeros(runs, 2, dtype=torch.float64), [], None
    for now in voltage.T:
        states.append(state)
        state, memory = step(plant, state, {"voltage": now}, TIME_STEP, memory or (), substeps=5)
    motion = torch.stack(states, 1).numpy() + random.normal(0.0, (2e-4, 2e-3), (runs, samples, 2))
    names = [f"run_{run}" for run in range(runs)]
    frame = pd.DataFrame(
        {
            "run": np.repeat(names, samples),
            "t": np.tile(np.arange(samples) * TIME_STEP, runs),
            "position": motion[..., 0].ravel(),
            "velocity": motion[..., 1].ravel(),
            "voltage": voltage.numpy().ravel(),
        }
    )
    units = {"position": "rad", "velocity": "rad/s", "voltage": "V"}
    split = {name: "holdout" if run % 4 == 3 else "train" for run, name in enumerate(names)}
    return Recording(frame, "joint", units, source="benchmark", split=split, cleaned=True)


def seconds_of(recording: Recording, effects: list[str] | None, rounds: int) -> float:
    """Return the processor time of a diagnosis, s, the median over rounds."""
    settings, taken = Gap(effects=effects, most_blocks=len(recording.frame)), []
    for _ in range(rounds):
        start = time.process_time()
        diagnose(recording, Simulator(JOINT), settings)
        taken.append(time.process_time() - start)
    return statistics.median(taken)


def catalogue() -> list[str]:
    """Return the names of all effects of a joint, those that are there first."""
    there = ["coulomb_friction", "viscous_friction"]
    return there + [effect.key for effect in effects_of("joint") if effect.key not in there]


def growth(rounds: int) -> tuple[list[list[str]], list[list[str]]]:
    """Return the rows of both tables: over the length of a recording, and over the size of the catalogue."""
    samples = [
        [
            f"{seconds:.0f}",
            f"{round(seconds / TIME_STEP):,}",
            f"{seconds_of(recording_of(seconds), None, rounds):.1f}",
        ]
        for seconds in SECONDS
    ]
    longest, every = recording_of(SECONDS[-1]), catalogue()
    some = [every[: round(share * len(every))] for share in SHARES]
    return samples, [[f"{len(names)}", f"{seconds_of(longest, names, rounds):.1f}"] for names in some]


def by_kind(results: list[dict[str, Any]]) -> Iterator[list[str]]:
    """Yield the row of each kind: cases, median, greatest and target, s of processor time, and whether it is met."""
    for kind, bar in BARS.items():
        busy = [
            r["seconds_busy"]
            for r in results
            if r.get("case", {}).get("kind") == kind and "seconds_busy" in r
        ]
        if busy:
            yield [
                kind,
                f"{len(busy)}",
                f"{statistics.median(busy):.1f}",
                f"{max(busy):.1f}",
                f"{bar:.0f}",
                _met(statistics.median(busy), max(busy), bar),
            ]


def _met(median: float, greatest: float, bar: float) -> str:
    return "met" if median <= bar and greatest <= WORST else "**missed**"


def written(
    results: list[dict[str, Any]],
    rows: tuple[list[list[str]], list[list[str]]],
    rounds: int,
    load: float,
    command: str,
) -> str:
    """Return the page."""
    kinds = list(by_kind(results))
    return _PAGE.format(
        command=command,
        day=date.today().isoformat(),
        machine=machine("cpu", load),
        seed=", ".join(str(seed) for seed in sorted({r["seed"] for r in results if "seed" in r})),
        cases=sum(int(row[1]) for row in kinds),
        worst=WORST,
        kinds=table(["kind", "cases", "median, s", "greatest, s", "target, s", ""], kinds),
        rounds=rounds,
        memory=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20,
        samples=table(["recorded, s", "samples", "processor time, s"], rows[0]),
        catalogue=len(catalogue()),
        longest=SECONDS[-1],
        effects=table(["entries", "processor time, s"], rows[1]),
    )


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.diagnosis")
    parser.add_argument("--results", type=Path, required=True, help="results.json of simgap prove")
    parser.add_argument("--output", type=Path, default=Path("docs/benchmark_diagnosis.md"))
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--command", default="make bench-diagnosis", help="that the page names")
    chosen = parser.parse_args()
    torch.set_num_threads(1)
    results = json.loads(chosen.results.read_text(encoding="utf-8"))
    load = os.getloadavg()[0]
    chosen.output.write_text(
        written(results, growth(chosen.rounds), chosen.rounds, load, chosen.command), encoding="utf-8"
    )
    print(f"wrote {chosen.output}")


if __name__ == "__main__":
    main()
