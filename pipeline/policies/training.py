"""Training that goes on where it was stopped."""

import math
from collections.abc import Callable, Iterable
from pathlib import Path

import torch

from simgap.artifacts import progress, staged_directory
from simgap.policies.accelerated import CapturedCollector, CapturedLearner
from simgap.policies.best import Best
from simgap.policies.collector import Collector
from simgap.policies.environment import Environment
from simgap.policies.ppo import Learner
from simgap.policies.settings import Learning

CHECKPOINT_FILE = "checkpoint.pt"

Curve = list[dict[str, float]]
Log = Callable[[dict[str, float], int], None]


class Training:
    """A learner, the machines that it learns from, and the learning curve so far.

    Attributes:
        learner: networks and optimiser.
        curve: one entry per update, with `interactions` so far.
        best: judges the policy at every checkpoint and at the end, and keeps the best; None: the last is kept.
    """

    def __init__(
        self, environment: Environment, settings: Learning, seed: int, best: Best | None = None
    ) -> None:
        self.settings = settings
        self.best = best
        self.learner = learner_for(environment, settings, seed)
        self.curve: Curve = []
        self._collector = collector_for(environment, seed)
        self._per_update = environment.batch * settings.horizon

    @property
    def updates(self) -> int:
        """How many updates there are in all."""
        return math.ceil(self.settings.interactions / self._per_update)

    def run(self, checkpoint: Path | None = None, log: Log | None = None) -> Curve:
        """Train to the end, from the checkpoint where there is one.

        Args:
            checkpoint: folder, written every `checkpoint_every` updates.
            log: told each entry of the curve and its number.

        Returns:
            The learning curve, with the part before an interruption.
        """
        if checkpoint is not None and (checkpoint / CHECKPOINT_FILE).exists():
            self._resume(checkpoint)
            for number, entry in enumerate(self.curve):
                _tell(log, entry, number)
        for update in progress(self._left(), "updates of the policy", len(self._left())):
            self.update()
            _tell(log, self.curve[-1], update)
            if len(self.curve) % self.settings.checkpoint_every == 0:
                self._consider()
                if checkpoint is not None:
                    self._write(checkpoint)
        self._consider()
        if self.best is not None:
            self.best.restore(self.learner.gaussian)
        return self.curve

    def update(self) -> None:
        """Collect a segment and learn from it."""
        share = len(self.curve) / self.updates
        learner, collector = self.learner, self._collector
        collector.environment.schedule(share)
        segment = collector.collect(
            learner.gaussian, learner.critic, self.settings.horizon, learner.generator
        )
        told = learner.learn(segment.steps, share)
        done = float((len(self.curve) + 1) * self._per_update)
        self.curve.append({"interactions": done, **segment.measures, **told})

    def _consider(self) -> None:
        if self.best is not None:
            self.best.consider(self.learner.gaussian)

    def _left(self) -> range:
        return range(len(self.curve), self.updates)

    def _write(self, folder: Path) -> None:
        content = {
            "learner": self.learner.snapshot(),
            "machines": self._collector.snapshot(),
            "curve": self.curve,
            "best": None if self.best is None else self.best.snapshot(),
        }
        with staged_directory(folder, owned=True) as staging:
            torch.save(content, staging / CHECKPOINT_FILE)

    def _resume(self, folder: Path) -> None:
        content = torch.load(folder / CHECKPOINT_FILE, weights_only=True, map_location="cpu")
        self.learner.resume(content["learner"])
        self._collector.resume(content["machines"])
        self.curve = content["curve"]
        if self.best is not None and content.get("best"):
            self.best.resume(content["best"])


def learner_for(environment: Environment, settings: Learning, seed: int) -> Learner:
    """Return what learns from an environment, as a CUDA graph where its steps are captured."""
    return (CapturedLearner if environment.captured else Learner)(environment, settings, seed)


def collector_for(environment: Environment, seed: int) -> Collector:
    """Return what acts in an environment, as a CUDA graph where its steps are captured."""
    return (CapturedCollector if environment.captured else Collector)(environment, seed)


def _tell(log: Log | None, entry: dict[str, float], number: int) -> None:
    if log is not None:
        log(entry, number)


def final(curve: Curve, share: float = 0.1) -> dict[str, float]:
    """Return the mean of each measure over the last part of a learning curve."""
    last: Iterable[dict[str, float]] = curve[-max(1, math.ceil(share * len(curve))) :]
    names = {name for entry in last for name in entry}
    series = {name: [entry[name] for entry in last if name in entry] for name in sorted(names)}
    return {name: sum(values) / len(values) for name, values in series.items()}
