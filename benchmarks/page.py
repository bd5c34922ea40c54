"""The page of the documentation that the measurements make."""

import os
import platform
import subprocess
from collections.abc import Iterable
from datetime import date
from importlib import metadata

import torch

from benchmarks.laps import Laps
from benchmarks.measure import OURS, Floor
from simgap.comparison.machine import processor

_HEAD = """# Benchmark

Made by `{command}` on {day}. Every figure below was measured in that one run. {machine}

Each contender is a process. The processes take turns, {rounds} rounds of laps of about {seconds} s, so that a
disturbance of the machine slows all of them alike. A rate is the median over the rounds; brackets give minimum and
maximum. A ratio is the median of the ratios within a round. A control step lasts 10 ms and has five inner steps of
2 ms. Computation is in single precision; rotorpy computes in double precision by default.
"""

_PEERS = """
## Comparison with other simulators

The unit is 10⁶ control steps per second, summed over all machines of the batch. Multiply by five for inner steps.

- **simgap**: the 870 g racer of `conf/platform/racer.yaml`. It has Betaflight's rate controller at every inner
  step, battery, speed controllers, motors, the torque of rotor acceleration and grey-box aerodynamics. The whole
  control step is compiled into one loop over the batch. *One inner step per call* compiles one inner step and calls
  it five times. *eager* compiles nothing and keeps gradients.
- **crazyflow** 0.4: its first-principles Crazyflie with rotors and linear drag, without a battery. Its own rate or
  attitude controller runs at 500 Hz, compiled by XLA. Euler integration is its default.
- **rotorpy** 3, batched: its Crazyflie with aerodynamics and its own rate controller, Runge–Kutta integration in
  eager PyTorch. It is measured with inner steps of 2 ms and, as it is usually run, with one step of 10 ms.
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
    for integrator, name in (("rk4", "Fourth-order Runge–Kutta"), ("euler", "Euler")):
        parts.append(f"\n### {name}\n\n" + _peer_table(peers, integrator))
    parts += [_bars(peers, residual), _floor_part(peers, floors), _linear_part(linear)]
    parts += [_residual_part(residual)]
    if effects:
        parts.append(_effect_part(effects))
    return "".join(parts)


def machine(device: str, load_before: float) -> str:
    """Return a sentence on the machine and what else ran on it."""
    graphics = f", {torch.cuda.get_device_name()} (driver {_driver()})" if device == "cuda" else ""
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30
    return (
        f"Machine: {processor()}{graphics}, {memory:.0f} GiB; Python {platform.python_version()}, "
        f"PyTorch {metadata.version('torch')}. Load average of the machine before the run {load_before:.1f}, after it "
        f"{os.getloadavg()[0]:.1f} (its own work included)."
    )


def _driver() -> str:
    """Return the version of the GPU's driver."""
    asked = ["nvidia-smi", "--query-gpu=driver_version", "--format=csv,noheader"]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout.split()[0]


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
    head = ["batch, integrator", "fastest peer", f"{OURS} over it", "ahead"]
    return "\n### Fastest simulator\n\n" + table(head, rows)


def _floor_part(peers: dict[tuple[int, str], dict[str, Laps]], floors: dict[int, Floor]) -> str:
    floor = next(iter(floors.values()))
    text = f"""
## Where the time goes

A machine has {floor.rows} numbers of state and memory. A control step that is one loop reads and writes
{8 * floor.rows} bytes per machine and does {floor.operations} arithmetic operations (Runge–Kutta; a root or an
exponential counts as one). Two lower bounds were measured in the same run: a copy of the same rows, and the same
number of operations in a compiled chain of multiplications and additions.

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
        f"\n## Cost per machine over the batch size\n\nThe time per machine differs by a factor of "
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
## Cost of the learned residual

The residual is the mean of the residuals at the five nearest of 1,000 samples, in seven features. It is evaluated
once per control step, for 10,000 machines. The unit of the rates is 10⁶ control steps per second. A residual over
physics of 1 doubles the time. All samples are compared: 1,000 distances in seven features are 21,000 operations (a
difference, a product and a sum each). The number of operations of the physics stands above.

"""
    return text + table(["path", "physics", "physics and residual", "residual over physics"], rows)


def _effect_part(effects: dict[str, tuple[Laps, Laps]]) -> str:
    shares = {key: bare.over(beside) - 1 for key, (bare, beside) in effects.items()}
    rows = [[key, f"{100 * share:.0f} %"] for key, share in sorted(shares.items(), key=lambda item: -item[1])]
    text = """
## Cost of each effect

The table gives the time that one effect of the catalogue adds to the control step of the racer with controller and
drive alone (Runge–Kutta, one inner step per call, 10,000 machines). An effect that is not in the simulator costs
nothing.

"""
    return text + table(["effect", "added time"], rows)
