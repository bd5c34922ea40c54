"""Training a racing policy, end to end: python -m benchmarks.policies --output PAGE.

The project's training beside a bare loop, and where its time goes.
"""

import argparse
import os
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from datetime import date
from functools import partial
from pathlib import Path

import torch

from benchmarks.bare_ppo import BarePPO
from benchmarks.laps import Laps, in_turns
from benchmarks.ours import RACING, flight
from benchmarks.page import machine, table
from simgap.policies.racing.entry import race_in
from simgap.policies.racing.racing import Racing
from simgap.policies.settings import Learning
from simgap.policies.training import Training, collector_for, learner_for
from simgap.runner.compose import compose, typed
from simgap.simulation import Simulator
from simgap.simulation.captured import Captured
from simgap.stages.train_policy import TrainPolicyStage

OURS, BARE = "simgap", "bare loop"
PUBLISHED = 1e8 / (50 * 60)  # Kaufmann et al. 2023, Nature 620, Methods: 10⁸ interactions in 50 minutes
BAR = 0.85
ROUNDS, UPDATES = 5, 3
DEVICES = {"cpu": "CPU", "cuda": "GPU"}
BATCH = ("machines", "horizon", "minibatch")
LARGE = (65_536, 32, 131_072)  # what fills a GPU
OTHERS = ((65_536, 32, 16_384), (2_048, 32, 8_192), (4_096, 32, 16_384), (100, 1_500, 16_384))

_HEAD = """# Policy training speed

The task is PPO on the Split-S course with the full racing quadrotor. Its simulator has Betaflight's rate controller
at every inner step, battery, speed controllers, motors, the torque of rotor acceleration and grey-box aerodynamics.
Control runs at 100 Hz with five inner steps each. Policy and critic have two layers of 128. All numbers are float32;
matrix products are not in TF32.

- *simgap* is `simgap train_policy`: simulation, advantages, learning, learning curve and checkpoints.
- The *bare loop* is the same physics, networks and updates in plain PyTorch. It has no TensorDict, torchrl, learning
  curve or checkpoints. It is captured in no CUDA graph.

They run in turns. A rate is the median over the rounds; brackets give minimum and maximum. The ratio is the median of
the ratios within a round.

The targets are:

- {published:,.0f} interactions/s, the rate of Kaufmann et al. 2023: 10⁸ in 50 minutes on an i9 with an RTX 3090;
- {bar:.0%} of the bare loop;
- 2 million interactions/s on a GPU.

`make bench-policies` uses a GPU where there is one, and leaves what was measured on the other kind of device.
"""

_SECTION = """{mark}
## On a {device}

Made by `{command}` on {day}. {machine}

An update takes {machines:,} machines × {horizon} steps, in {epochs} passes with minibatches of {minibatch:,}. There
were {rounds} rounds of {updates} updates each, with {threads} threads.

{rates}
10⁸ interactions take {time} at this rate.

The parts of one update of simgap, each measured on its own in this run:

{parts}{batches}"""

_BATCHES = """
Other batches, one lap of {updates} updates each after one that is not timed. The last but one is that of
`train_policy=racing`, the last that of Kaufmann et al. 2023.

{rates}"""


def settings(updates: int, **batch: int) -> Learning:
    """Return the learning of `conf/train_policy/racing.yaml` over some updates.

    Args:
        updates: how many.
        batch: `machines`, `horizon` or `minibatch`, where they are others.
    """
    config = typed(TrainPolicyStage, compose(["track=split_s", "train_policy=racing"]))
    learning = replace(config.train_policy.learning, **batch)
    return replace(learning, interactions=updates * learning.machines * learning.horizon)


def race(learning: Learning, device: str) -> Racing:
    """Return the full racing quadrotor on the Split-S course."""
    config = typed(TrainPolicyStage, compose(["track=split_s", "train_policy=racing"]))
    flying = flight(RACING, "rk4", residual=False, device=device, substeps=5)
    without_drive = tuple(f for f in flying.simulator.effects if f.effect.name != "powertrain")
    simulator = Simulator(flying.simulator.platform, without_drive)
    return race_in(simulator, config.track, config.train_policy.racing, learning.machines, device)


def ours(environment: Racing, learning: Learning) -> float:
    """Return interactions per second of the project's training."""
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        Training(environment, learning, seed=0).run(Path(folder) / "checkpoint", lambda entry, number: None)
        return learning.interactions / (time.perf_counter() - start)


def bare(environment: Racing, learning: Learning) -> float:
    """Return interactions per second of the bare loop."""
    start = time.perf_counter()
    training = BarePPO(environment, learning, seed=0)
    for _ in range(learning.interactions // (learning.machines * learning.horizon)):
        training.update()
    return learning.interactions / (time.perf_counter() - start)


def parts(environment: Racing, learning: Learning) -> dict[str, float]:
    """Return the seconds of an update that each part takes."""
    learner, collector = learner_for(environment, learning, 0), collector_for(environment, 0)
    gaussian, critic, random = learner.gaussian, learner.critic, learner.generator
    seen, state = collector.observation.policy, dict(environment.state)
    action = torch.zeros(environment.batch, environment.action_size, device=environment.device)
    command = torch.zeros_like(action)
    collected = _seconds(
        lambda: collector.collect(gaussian, critic, learning.horizon, random), environment, 5
    )
    steps = collector.collect(gaussian, critic, learning.horizon, random).steps
    learnt = _seconds(lambda: learner.learn(steps, 0.0), environment, 3)
    rows = environment.state["rows"].clone()
    with torch.no_grad():
        works: list[Callable[[], object]] = [
            lambda: environment.fleet.step(rows, command),
            lambda: environment.step(action),
            lambda: gaussian.sample(seen, random),
        ]
        flown, stepped, chosen = (
            _seconds(_as_trained(work, environment, random), environment) * learning.horizon for work in works
        )
    environment.state = state
    return {
        "physics, compiled": flown,
        "gates, reward, observation, new starts": stepped - flown,
        "choosing actions": chosen,
        "values and storage": collected - stepped - chosen,
        "advantage and learning": learnt,
    }


def _as_trained(
    work: Callable[[], object], environment: Racing, random: torch.Generator
) -> Callable[[], object]:
    """Return a piece of work as a training does it: captured where the environment is."""
    if not environment.captured:
        return work
    return Captured(lambda: (work(), None)[1], (random, environment.generator), environment.device)


def _seconds(work: Callable[[], object], environment: Racing, repeats: int = 20) -> float:
    """Return the seconds of a piece of work: the median of some."""
    wait = torch.cuda.synchronize if environment.device.type == "cuda" else lambda: None
    times = []
    for _ in range(repeats + 5):  # the first ones compile and capture
        wait()
        start = time.perf_counter()
        work()
        wait()
        times.append(time.perf_counter() - start)
    return sorted(times[5:])[repeats // 2]


def written(
    laps: dict[str, Laps],
    shares: dict[str, float],
    learning: Learning,
    rounds: int,
    updates: int,
    description: str,
    device: str = "cpu",
    batches: dict[tuple[int, int, int], float] | None = None,
) -> str:
    """Return the section of a device."""
    ratio = laps[OURS].over(laps[BARE])
    rows = [[name, _text(series)] for name, series in laps.items()]
    rows += [["simgap over the bare loop", f"{ratio:.0%}"]]
    rows += [["simgap over the published rate", f"{laps[OURS].median / PUBLISHED:.2f}×"]]
    whole, seconds = sum(shares.values()), 1e8 / laps[OURS].median
    return _SECTION.format(
        mark=_mark(device),
        device=DEVICES[device],
        command=_command(rounds, updates),
        day=date.today().isoformat(),
        machine=description,
        machines=learning.machines,
        horizon=learning.horizon,
        epochs=learning.epochs,
        minibatch=learning.minibatch,
        rounds=rounds,
        updates=updates,
        threads=torch.get_num_threads(),
        rates=table(["", "interactions/s"], rows),
        time=f"{seconds / 60.0:.0f} minutes" if seconds > 120.0 else f"{seconds:.0f} s",
        parts=table(
            ["part", "ms per update", "share"],
            [[name, f"{1e3 * taken:.3g}", f"{taken / whole:.0%}"] for name, taken in shares.items()],
        ),
        batches=_batches(batches, updates) if batches else "",
    )


def _command(rounds: int, updates: int) -> str:
    if (rounds, updates) == (ROUNDS, UPDATES):
        return "make bench-policies"
    return f"python -m benchmarks.policies --rounds {rounds} --updates {updates}"


def _batches(batches: dict[tuple[int, int, int], float], updates: int) -> str:
    rows = [[*(f"{size:,}" for size in sizes), f"{rate:,.0f}"] for sizes, rate in batches.items()]
    return _BATCHES.format(
        updates=updates, rates=table(["machines", "horizon", "minibatch", "interactions/s"], rows)
    )


def _mark(device: str) -> str:
    return f"<!-- device: {device} -->"


def on_page(page: str, section: str, device: str) -> str:
    """Return a page with the section of a device in the place of what stood there."""
    sections = {}
    for known in DEVICES:
        if _mark(known) in page:
            sections[known] = _mark(known) + page.split(_mark(known))[1].split("<!-- device: ")[0]
    sections[device] = section
    ordered = [sections[known].rstrip("\n") for known in DEVICES if known in sections]
    return "\n\n".join([_HEAD.format(published=PUBLISHED, bar=BAR).rstrip("\n"), *ordered]) + "\n"


def _text(laps: Laps) -> str:
    low, high = laps.spread
    return f"{laps.median:,.0f} ({low:,.0f}–{high:,.0f})"


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.policies")
    parser.add_argument("--output", type=Path, default=Path("docs/benchmark_policies.md"))
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--updates", type=int, default=UPDATES, help="of a lap")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    for name in BATCH:
        parser.add_argument(f"--{name}", type=int, help="of an update")
    chosen = parser.parse_args()
    torch.set_num_threads(chosen.threads)
    load, device = os.getloadavg()[0], chosen.device
    batch = {name: getattr(chosen, name) or size for name, size in zip(BATCH, LARGE, strict=True)}
    learning = settings(chosen.updates, **(batch if device == "cuda" else {}))
    environment = race(learning, device)
    contenders = {OURS: partial(ours, environment, learning), BARE: partial(bare, environment, learning)}
    laps = in_turns(contenders, chosen.rounds)
    shares = parts(environment, learning)
    batches = {sizes: _rate(sizes, chosen.updates, device) for sizes in OTHERS} if device == "cuda" else None
    description = machine(device, load)
    text = written(laps, shares, learning, chosen.rounds, chosen.updates, description, device, batches)
    page = chosen.output.read_text(encoding="utf-8") if chosen.output.exists() else ""
    chosen.output.write_text(on_page(page, text, device), encoding="utf-8")
    print(f"wrote {chosen.output}")


def _rate(sizes: tuple[int, int, int], updates: int, device: str) -> float:
    """Return interactions per second with another batch, once everything is captured."""
    learning = settings(2 * updates, **dict(zip(BATCH, sizes, strict=True)))
    training = Training(race(learning, device), learning, seed=0)
    seconds = []
    for _ in range(2):
        start = time.perf_counter()
        for _ in range(updates):
            training.update()
        seconds.append(time.perf_counter() - start)
    return updates * learning.machines * learning.horizon / seconds[-1]


if __name__ == "__main__":
    main()
