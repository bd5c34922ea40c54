"""The page of the documentation that the measurements make."""

import os
import platform
from collections.abc import Iterable
from datetime import date
from importlib import metadata

import torch

from benchmarks.laps import Laps
from benchmarks.measure import OURS, Floor
from simgap.comparison.machine import processor

_HEAD = """# Benchmark

Made by `{command}` on {day}; every figure below was measured in that one run. {machine}

Contenders are processes that run laps in turns, {rounds} rounds of laps of about {seconds} s, so that whatever else
slows the machine down slows all of them down. A rate is the median over the rounds, in brackets the least and the
greatest. Ratios are medians of the ratios within a round. Control steps are at 100 Hz, each of five inner steps at
500 Hz, in single precision (rotorpy computes in double, as it comes).
"""

_PEERS = """
## Beside its peers

Millions of control steps a second, of all machines together; multiply by five for inner steps.

- **simgap**: the 870 g racer of `conf/platform/racer.yaml` with Betaflight's rate controller at every inner step,
  battery, speed controllers, motors, the torque of rotor acceleration and the grey-box aerodynamics; the whole
  control step is compiled into one loop over the batch. *An inner step per call* compiles one inner step and calls
  it five times; *eager* compiles nothing and keeps gradients.
- **crazyflow** 0.4: its first-principles Crazyflie (rotors, linear drag; no battery), its own rate or attitude
  controller at 500 Hz, compiled by XLA. Its integrator is Euler's rule unless Runge and Kutta's is asked for.
- **rotorpy** 3, batched: its Crazyflie with aerodynamics and its own rate controller, Runge and Kutta's rule in
  PyTorch's eager mode. It is measured at inner steps of 2 ms, and as it is commonly run, at one step of 10 ms.
"""


def written(
    machine: str,
    command: str,
    rounds: int,
    seconds: float,
    peers: dict[tuple[int, str], dict[str, Laps]],
    linear: dict[int, Laps],
    floors: dict[int, Floor],
    residual: dict[str, Laps],
    effects: dict[str, tuple[Laps, Laps]],
) -> str:
    """Return the page."""
    head = _HEAD.format(
        command=command, day=date.today().isoformat(), machine=machine, rounds=rounds, seconds=seconds
    )
    parts = [head, _PEERS]
    for integrator, name in (("rk4", "Runge and Kutta's rule, fourth order"), ("euler", "Euler's rule")):
        parts.append(f"\n### {name}\n\n" + _peer_table(peers, integrator))
    parts += [_bars(peers, residual), _floor_part(peers, floors), _linear_part(linear)]
    parts += [_residual_part(residual)]
    if effects:
        parts.append(_effect_part(effects))
    return "".join(parts)


def machine(device: str, load_before: float) -> str:
    """Return a sentence on the machine and what else ran on it."""
    graphics = f", {torch.cuda.get_device_name()}" if device == "cuda" else ""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return (
        f"Machine: {processor()}{graphics}, {memory:.0f} GiB; Python {platform.python_version()}, "
        f"PyTorch {metadata.version('torch')}. Load average of the machine before the run {load_before:.1f}, after it "
        f"{os.getloadavg()[0]:.1f} (its own work included)."
    )


def table(head: list[str], rows: Iterable[list[str]]) -> str:
    """Return a table in Markdown; all columns but the first are numbers."""
    lines = [head, ["---", *["--:"] * (len(head) - 1)], *rows]
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def _rate(laps: Laps) -> str:
    low, high = laps.spread
    return f"{_number(laps.median / 1e6)} ({_number(low / 1e6)}–{_number(high / 1e6)})"


def _number(value: float) -> str:
    return f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def _peer_table(peers: dict[tuple[int, str], dict[str, Laps]], integrator: str) -> str:
    batches = [batch for batch, rule in peers if rule == integrator]
    names = peers[batches[0], integrator]
    rows = [[name, *(_rate(peers[batch, integrator][name]) for batch in batches)] for name in names]
    for name in names:
        if not name.startswith(OURS):
            ratios = [peers[b, integrator][OURS].over(peers[b, integrator][name]) for b in batches]
            rows.append([f"{OURS} over {name}", *(f"**{_number(ratio)}×**" for ratio in ratios)])
    return table(["batch", *(f"{batch:,}" for batch in batches)], rows)


def _bars(peers: dict[tuple[int, str], dict[str, Laps]], residual: dict[str, Laps]) -> str:
    rows = []
    for (batch, integrator), laps in peers.items():
        others = [name for name in laps if not name.startswith(OURS)]
        if others:
            fastest = max(others, key=lambda name: laps[name].median)
            ratio = laps[OURS].over(laps[fastest])
            ahead = OURS if ratio > 1 else fastest
            rows.append([f"{batch:,}, {integrator}", fastest, f"{_number(ratio)}×", ahead])
    return "\n### Who is ahead\n\n" + table(["batch, rule", "fastest peer", f"{OURS} over it", "ahead"], rows)


def _floor_part(peers: dict[tuple[int, str], dict[str, Laps]], floors: dict[int, Floor]) -> str:
    floor = next(iter(floors.values()))
    text = f"""
## Where the time goes

A machine is {floor.rows} numbers of state and memory: {8 * floor.rows} bytes are read and written in a control step
that is one loop, and {floor.operations} operations of arithmetic are done (Runge and Kutta's rule; a root or an
exponential counts as one). The floors are a copy of the same rows, and the same number of operations in a compiled
chain of multiplications and additions, both measured in this run.

"""
    rows = []
    for batch, bound in floors.items():
        taken = batch / peers[batch, "rk4"][OURS].median
        least = max(bound.copy_seconds, bound.arithmetic_seconds)
        rows.append(
            [
                f"{batch:,}",
                _number(1e6 * taken),
                _number(1e6 * bound.copy_seconds),
                _number(1e6 * bound.arithmetic_seconds),
                f"{_number(taken / bound.copy_seconds)}×",
                f"{_number(taken / least)}×",
            ]
        )
    columns = ["control step, µs", "copy, µs", "arithmetic, µs", "over the copy", "over the higher floor"]
    return text + table(["batch", *columns], rows)


def _linear_part(linear: dict[int, Laps]) -> str:
    each = {batch: 1e9 / laps.median for batch, laps in linear.items()}
    rows = [[f"{batch:,}", _rate(linear[batch]), _number(value)] for batch, value in each.items()]
    ratio = max(each.values()) / min(each.values())
    text = (
        f"\n## Cost grows with the batch\n\nThe time of a machine's control step differs by a factor of "
        f"{_number(ratio)} between {min(linear):,} and {max(linear):,} machines.\n\n"
    )
    return text + table(["batch", "control steps, 10⁶/s", "ns per machine and control step"], rows)


def _residual_part(residual: dict[str, Laps]) -> str:
    rows = []
    for path in ("eager", "whole"):
        without, beside = residual[path], residual[f"{path}, residual"]
        share = without.over(beside) - 1
        rows.append([path, _rate(without), _rate(beside), _number(share)])
    text = """
## What the residual costs

The mean of the residuals at the five nearest of 1,000 samples, in seven features, once in a control step; 10,000
machines. Millions of control steps a second; a cost of 1 is that of the physics. All samples are looked at: 1,000
distances in seven features are 21,000 operations (a difference, a product and a sum each) before the nearest are picked
out; how many the physics takes stands above.

"""
    return text + table(
        ["path", "physics", "physics and residual", "cost of the residual over physics"], rows
    )


def _effect_part(effects: dict[str, tuple[Laps, Laps]]) -> str:
    shares = {key: bare.over(beside) - 1 for key, (bare, beside) in effects.items()}
    rows = [[key, f"{100 * share:.0f} %"] for key, share in sorted(shares.items(), key=lambda item: -item[1])]
    text = """
## What each effect costs

Time added to the control step of the racer with controller and drive alone (Runge and Kutta's rule, an inner step
per call, 10,000 machines) by one effect of the catalogue; nothing where it is not in the simulator.

"""
    return text + table(["effect", "added time"], rows)
