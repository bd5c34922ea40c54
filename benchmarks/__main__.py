"""Measure, and write the page: python -m benchmarks --peers PYTHON --output PAGE."""

import argparse
import os
from pathlib import Path

import torch

from benchmarks import measure, page


def main() -> None:
    """Run the benchmark."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks")
    parser.add_argument("--peers", default=".venv-bench/bin/python", help="Python that has the peers")
    parser.add_argument("--output", type=Path, default=Path("docs/benchmark.md"))
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--seconds", type=float, default=0.5, help="of a lap")
    parser.add_argument("--no-effects", action="store_true", help="leave the cost of each effect out")
    chosen = parser.parse_args()
    torch.set_num_threads(len(os.sched_getaffinity(0)))
    load = os.getloadavg()[0]
    plan = measure.Plan(chosen.peers, chosen.device, chosen.rounds, chosen.seconds)
    peers = measure.against_peers(plan)
    linear = measure.linearity(plan)
    floors = measure.floors(plan, measure.BATCHES[plan.device])
    residual = measure.residual_cost(plan)
    effects = {} if chosen.no_effects else measure.effect_costs(plan)
    text = page.written(
        page.machine(plan.device, load),
        "make bench",
        plan.rounds,
        plan.seconds,
        peers,
        linear,
        floors,
        residual,
        effects,
    )
    chosen.output.write_text(text, encoding="utf-8")
    print(f"wrote {chosen.output}")


if __name__ == "__main__":
    main()
