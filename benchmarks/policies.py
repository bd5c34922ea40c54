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
from simgap.policies.collector import Collector
from simgap.policies.ppo import Learner
from simgap.policies.racing.entry import race_in
from simgap.policies.racing.racing import Racing
from simgap.policies.settings import Learning
from simgap.policies.training import Training
from simgap.runner.compose import compose, typed
from simgap.simulation import Simulator
from simgap.stages.train_policy import TrainPolicyStage

OURS, BARE = "simgap", "bare loop"
PUBLISHED = 1e8 / (50 * 60)  # Kaufmann et al. 2023, Nature 620, Methods: 10⁸ interactions in 50 minutes
BAR = 0.85

_PAGE = """# Policy training speed

Made by `{command}` on {day}. {machine}

The task is PPO on the Split-S course with the full racing quadrotor. Its simulator has Betaflight's rate controller
at every inner step, battery, speed controllers, motors, the torque of rotor acceleration and grey-box aerodynamics.
Control runs at 100 Hz with five inner steps each. An update takes {machines:,} machines × {horizon} steps, in
{epochs} passes with minibatches of {minibatch:,}. Policy and critic have two layers of {hidden}.

- *simgap* is `simgap train_policy`: simulation, advantages, learning, learning curve and checkpoints.
- The *bare loop* is the same physics, networks and updates in plain PyTorch. It has no TensorDict, torchrl, learning
  curve or checkpoints.

They run in turns: {rounds} rounds of {updates} updates each, with {threads} threads. A rate is the median over the
rounds; brackets give minimum and maximum. The ratio is the median of the ratios within a round.

The targets are:

- {published:,.0f} interactions/s, the rate of Kaufmann et al. 2023: 10⁸ in 50 minutes on an i9 with an RTX 3090;
- {bar:.0%} of the bare loop;
- 2 million interactions/s on a GPU of the H200 class. This was measured only if the page names such a GPU.
  `make bench-policies` uses a GPU where there is one.

{rates}
10⁸ interactions take {minutes:.0f} minutes at this rate.

## Where the time goes

The parts of one update of simgap, each measured on its own in this run.

{parts}
"""


def settings(updates: int) -> Learning:
    """Return the learning of `conf/train_policy/racing.yaml` over some updates."""
    config = typed(TrainPolicyStage, compose(["track=split_s", "train_policy=racing"]))
    learning = config.train_policy.learning
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
    learner, collector = Learner(environment, learning, 0), Collector(environment, 0)
    gaussian, critic, random = learner.gaussian, learner.critic, learner.generator
    seen = collector.observation.policy
    action = torch.zeros(environment.batch, environment.action_size, device=environment.device)
    command = torch.zeros_like(action)
    rows = environment.state["rows"].clone()
    flown = _seconds(lambda: environment.fleet.step(rows, command), environment) * learning.horizon
    stepped = _seconds(lambda: environment.step(action), environment) * learning.horizon
    with torch.no_grad():
        chosen = _seconds(lambda: gaussian.sample(seen, random), environment) * learning.horizon
    collected = _seconds(
        lambda: collector.collect(gaussian, critic, learning.horizon, random), environment, 3
    )
    steps = collector.collect(gaussian, critic, learning.horizon, random).steps
    learnt = _seconds(lambda: learner.learn(steps, 0.0), environment, 3)
    return {
        "physics, compiled": flown,
        "gates, reward, observation, new starts": stepped - flown,
        "choosing actions": chosen,
        "values and storage": collected - stepped - chosen,
        "advantage and learning": learnt,
    }


def _seconds(work: Callable[[], object], environment: Racing, repeats: int = 20) -> float:
    """Return the seconds of a piece of work: the median of some."""
    wait = torch.cuda.synchronize if environment.device.type == "cuda" else lambda: None
    times = []
    for _ in range(repeats + 1):
        start = time.perf_counter()
        work()
        wait()
        times.append(time.perf_counter() - start)
    return sorted(times[1:])[repeats // 2]


def written(
    laps: dict[str, Laps],
    shares: dict[str, float],
    learning: Learning,
    rounds: int,
    updates: int,
    description: str,
) -> str:
    """Return the page."""
    ratio = laps[OURS].over(laps[BARE])
    rows = [[name, _text(series)] for name, series in laps.items()]
    rows += [["simgap over the bare loop", f"{ratio:.0%}"]]
    rows += [["simgap over the published rate", f"{laps[OURS].median / PUBLISHED:.2f}×"]]
    whole = sum(shares.values())
    return _PAGE.format(
        command="make bench-policies",
        day=date.today().isoformat(),
        machine=description,
        machines=learning.machines,
        horizon=learning.horizon,
        epochs=learning.epochs,
        minibatch=learning.minibatch,
        hidden=learning.hidden[0],
        rounds=rounds,
        updates=updates,
        threads=torch.get_num_threads(),
        published=PUBLISHED,
        bar=BAR,
        rates=table(["", "interactions/s"], rows),
        minutes=1e8 / laps[OURS].median / 60.0,
        parts=table(
            ["part", "ms per update", "share"],
            [[name, f"{1e3 * taken:.0f}", f"{taken / whole:.0%}"] for name, taken in shares.items()],
        ),
    )


def _text(laps: Laps) -> str:
    low, high = laps.spread
    return f"{laps.median:,.0f} ({low:,.0f}–{high:,.0f})"


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.policies")
    parser.add_argument("--output", type=Path, default=Path("docs/benchmark_policies.md"))
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--updates", type=int, default=3, help="of a lap")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    chosen = parser.parse_args()
    torch.set_num_threads(chosen.threads)
    load = os.getloadavg()[0]
    learning = settings(chosen.updates)
    environment = race(learning, chosen.device)
    contenders = {OURS: partial(ours, environment, learning), BARE: partial(bare, environment, learning)}
    laps = in_turns(contenders, chosen.rounds)
    shares = parts(environment, learning)
    description = machine(chosen.device, load)
    text = written(laps, shares, learning, chosen.rounds, chosen.updates, description)
    chosen.output.write_text(text, encoding="utf-8")
    print(f"wrote {chosen.output}")


if __name__ == "__main__":
    main()
