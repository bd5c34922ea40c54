"""Laps of a race and their statistics. A lap with a crash does not count."""

from collections.abc import Callable
from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.policies.environment import Observation
from simgap.policies.racing.flying import STATE
from simgap.policies.racing.racing import Racing
from simgap.policies.racing.starts import first_starts, perturbed

Pilot = Callable[[Observation], Tensor]
"""From what is seen of all machines to their actions (batch, 4)."""


@dataclass(frozen=True)
class Laps:
    """What some machines flew, each from a start of its own.

    Attributes:
        times: of laps that were completed, (machines, laps) s; not a number where there is none.
        margins: distance to the nearest edge of the opening at each gate that was passed, (passes,) m.
        passed: gates that each machine has passed, (machines,).
        gates: that each machine was to pass.
        states: (steps, machines, 13), a period apart; not a number after a machine's end.
    """

    times: Tensor
    margins: Tensor
    passed: Tensor
    gates: int
    states: Tensor

    @property
    def fastest(self) -> int:
        """The machine that flew the fastest lap; where nobody flew one, the one that came furthest."""
        times = self.times.nan_to_num(nan=torch.inf).amin(1)
        return int(times.argmin() if bool(times.isfinite().any()) else self.passed.argmax())

    def metrics(self) -> dict[str, float]:
        """Return the measures of a race; times and margins are missing where there are none."""
        found = self.times[self.times.isfinite()]
        measures = {
            "completed": float((self.passed / self.gates).mean()),
            "laps_completed": len(found) / self.times.numel(),
        }
        if len(found):
            measures |= {"fastest_lap": float(found.min()), "mean_lap": float(found.mean())}
        if len(self.margins):
            measures |= {
                "mean_margin": float(self.margins.mean()),
                "least_margin": float(self.margins.min()),
            }
        return measures


@torch.no_grad()
def fly_laps(environment: Racing, pilot: Pilot, seed: int, laps: int = 2, seconds: float = 60.0) -> Laps:
    """Let every machine fly laps from a perturbed start beyond the last gate.

    A lap is timed from the first gate to the first gate. A machine's flight ends with its laps, its crash or the time.

    Args:
        environment: whose machines fly; their episodes end no more by their length.
        pilot: chooses the actions.
        seed: of the perturbations.
        laps: that each machine is to complete.
        seconds: after which all flights end.
    """
    steps = round(seconds / environment.period)
    environment.episode_steps = steps + 1
    observation = _line_up(environment, seed)
    recorder = _Recorder(environment, laps)
    for _ in range(steps):
        states = environment.state["rows"][:STATE].T.clone()
        observation = environment.step(pilot(observation)).observation
        recorder.note(states)
        if not bool(recorder.flying.any()):
            break
    return recorder.laps()


def _line_up(environment: Racing, seed: int) -> Observation:
    environment.start(seed)
    settings, track = environment.settings.starts, environment.track
    state = first_starts(track, settings)[-1, :1].expand(environment.batch, STATE)
    machines = torch.arange(environment.batch, device=environment.device)
    first, last = torch.zeros_like(machines), torch.full_like(machines, len(track) - 1)
    environment.place(machines, perturbed(state, last, track, settings, environment.generator), first)
    return environment.observe()


class _Recorder:
    """Writes down what happens, machine by machine."""

    def __init__(self, environment: Racing, laps: int) -> None:
        self.environment = environment
        self.gates = laps * len(environment.track) + 1
        batch, device = environment.batch, environment.device
        self.flying = torch.ones(batch, dtype=torch.bool, device=device)
        self.passed = torch.zeros(batch, dtype=torch.int64, device=device)
        self.crossings = torch.full((batch, laps + 1), torch.nan, device=device)
        self.margins: list[Tensor] = []
        self.states: list[Tensor] = []

    def note(self, states: Tensor) -> None:
        """Take down the step that was just made, from these states on."""
        environment, happened = self.environment, self.environment.passage
        assert happened is not None
        self.states.append(torch.where(self.flying[:, None], states, torch.nan))
        passed = happened.passed & ~environment.crashed & self.flying
        over = passed & (self.passed % len(environment.track) == 0)
        lap = (self.passed[over] // len(environment.track)).long()
        self.crossings[over, lap] = len(self.states) * environment.period
        self.margins.append(happened.margin[passed])
        self.passed += passed
        self.flying &= ~environment.crashed & (self.passed < self.gates)

    def laps(self) -> Laps:
        """Return what was taken down."""
        states = torch.stack(self.states)
        return Laps(self.crossings.diff(dim=1), torch.cat(self.margins), self.passed, self.gates, states)
