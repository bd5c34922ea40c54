"""The environment of a race."""

from typing import Protocol, runtime_checkable

import torch
from torch import Tensor

from simgap.gates.track import Track
from simgap.policies.environment import Environment, Machines, Observation
from simgap.policies.racing.flying import STATE, Fleet, Flown, features_of, state_of
from simgap.policies.racing.observation import POLICY_SIZE, PRIVILEGED_SIZE, racing_observation
from simgap.policies.racing.passage import Passage, passage
from simgap.policies.racing.randomisation import DRAWN, drawn_episode, drawn_wrench
from simgap.policies.racing.reward import racing_reward, reward_at
from simgap.policies.racing.settings import Flying, RacingSettings
from simgap.policies.racing.starts import drawn_start, first_starts, keep
from simgap.simulation.flight import Flight

_COUNTED = ("gates", "crashes", "steps")


@runtime_checkable
class Misjudging(Protocol):
    """Errors of on-board estimates, as functions of the true state."""

    def __len__(self) -> int:
        """Return how many functions there are."""

    def __call__(self, state: dict[str, Tensor], moments: Tensor, which: Tensor) -> dict[str, Tensor]:
        """Return what is believed of states, each part (batch, ...), at moments (batch,) s of functions (batch,)."""


class Racing(Environment):
    """Quadrotors that race through gates; an episode ends with a crash, or with a gate that is missed.

    Its state: `rows` of the fleet; `target`, the next gate's index; `previous`, the action before, within ±1;
    `starts` and `drawn`, see the modules `starts` and `randomisation`; `misjudged`, the function by which each machine
    misjudges where it is; `counts` of what happened.

    Attributes:
        track: on the device.
        crash_cost: what a crash costs now, a tensor without dimensions.
        passage: what happened at the gates in the last step.
        crashed: in the last step, (batch,) bool.
    """

    observation_size = POLICY_SIZE
    privileged_size = PRIVILEGED_SIZE
    action_size = 4

    def __init__(
        self,
        flight: Flight,
        track: Track,
        settings: RacingSettings,
        batch: int,
        device: torch.device | str = "cpu",
        machines: Flown | None = None,
        misjudging: Misjudging | None = None,
        planned: Tensor | None = None,
    ) -> None:
        """Put machines on a track.

        Args:
            flight: of the simulator.
            track: its gates.
            settings: of the race.
            batch: machines.
            device: where they are.
            machines: that are flown in the place of the simulator's; for flights, not for training.
            misjudging: how the machines misjudge their states; None: they know them.
            planned: states after each gate to start from beside others, (gates, states, 13); None: there is no plan.
        """
        super().__init__(batch, device)
        self.settings = settings
        self.period = flight.period
        self.episode_steps = settings.episode_steps
        self.track = track.to(device)
        self.fleet = machines or Fleet(flight, device)
        self.misjudging = misjudging
        self.planned = planned
        self.gravity = flight.simulator.platform.gravity
        self.inertia = torch.tensor(flight.simulator.platform.inertia, device=self.device)
        self.passage: Passage | None = None
        self.crashed = torch.zeros(batch, dtype=torch.bool, device=self.device)
        self.crash_cost = torch.tensor(settings.reward.crash, device=self.device)
        self.captured = self.device.type == "cuda" and isinstance(self.fleet, Fleet) and self.fleet.compiled

    def schedule(self, share: float) -> None:
        """Let a crash cost what it costs when so much of the training is done."""
        self.crash_cost.fill_(reward_at(self.settings.reward, share).crash)

    def reset(self, machines: Tensor) -> None:
        """Put machines near a state in which a gate was passed; the gate is drawn."""
        if "rows" not in self.state:
            self._begin()
        settings = self.settings.starts
        gates, states = drawn_start(self.state["starts"], len(machines), self.track, settings, self.generator)
        self.place(machines, states, (gates + 1) % len(self.track))

    def place(self, machines: Tensor, states: Tensor, target: Tensor) -> None:
        """Put machines into states (machines, 13), with the next gate (machines,) and hover as the action before.

        Args:
            machines: indices, or a mask; then states and gates are those of the whole batch.
            states: see `simgap.simulation.motion.QuadrotorMotion`.
            target: indices of gates.
        """
        self._put("rows", machines, self.fleet.rows(states))
        self._put("target", machines, target)
        self._put("previous", machines, torch.zeros_like(states[:, :4]))
        if self.settings.randomisation.enabled:
            drawn = drawn_episode(len(machines), self.settings.randomisation, self.generator)
            self._put("drawn", machines, drawn)
        if self.misjudging is not None:
            which = torch.randint(
                len(self.misjudging), machines.shape, generator=self.generator, device=self.device
            )
            self._put("misjudged", machines, which)

    def _put(self, name: str, machines: Tensor, fresh: Tensor) -> None:
        """Give some machines a new part of the state; machines are the columns of the rows, and the rows of others."""
        kept = self.state[name]
        along = 1 if name == "rows" else 0
        if machines.dtype != torch.bool:
            kept.index_copy_(along, machines, fresh)
        else:
            chosen = machines[:, None] if kept.ndim == 2 and along == 0 else machines
            self.state[name] = torch.where(chosen, fresh, kept)

    def _begin(self) -> None:
        batch = self.batch
        self.state |= {
            "starts": first_starts(self.track, self.settings.starts, self.planned),
            "rows": self.fleet.rows(torch.zeros(batch, STATE, device=self.device)),
            "target": torch.zeros(batch, dtype=torch.int64, device=self.device),
            "previous": torch.zeros(batch, 4, device=self.device),
            "drawn": torch.zeros(batch, DRAWN, device=self.device),
            "misjudged": torch.zeros(batch, dtype=torch.int64, device=self.device),
            "counts": torch.zeros(len(_COUNTED), dtype=torch.float64, device=self.device),
        }

    def advance(self, action: Tensor) -> tuple[Tensor, Tensor]:
        """Fly for a period."""
        now, flying = self.state, self.settings.flying
        command = commanded(action, flying, self.gravity)
        previous = commanded(now["previous"], flying, self.gravity)
        before, target = now["rows"][:3].T, now["target"]
        now["rows"] = self.fleet.step(now["rows"], command, self._drawn_wrench(command))
        after = state_of(now["rows"])
        self.passage = passage(self.track, before, after["position"], target, self.settings.missed)
        self.crashed = self.passage.hit | self.passage.missed | self.track.outside(after["position"])
        gate = self.track.centres[target]
        reward = racing_reward(
            self.settings.reward, before, after, gate, command, previous, self.crashed, self.crash_cost
        )
        self._account(self.passage.passed & ~self.crashed)
        now["previous"] = action
        return reward, self.crashed

    def _drawn_wrench(self, command: Tensor) -> Tensor | None:
        if not self.settings.randomisation.enabled:
            return None
        features = features_of(self.state["rows"], command)
        return drawn_wrench(self.state["drawn"], features, self.inertia)

    def _account(self, passed: Tensor) -> None:
        """Send the machines that have passed a gate to the next one, and remember how they passed."""
        now = self.state
        states, gates = now["rows"][:STATE].T, now["target"]
        some = slice(None) if self.captured else passed.nonzero()[:, 0]
        keep(now["starts"], gates[some], states[some], self.settings.starts, self.generator, passed[some])
        now["target"] = torch.where(passed, (now["target"] + 1) % len(self.track), now["target"])
        counted = [passed.sum(), self.crashed.sum(), torch.full_like(passed.sum(), self.batch)]
        now["counts"] += torch.stack(counted)

    def observe(self, machines: Machines = slice(None)) -> Observation:
        """Return what is seen, see `simgap.policies.racing.observation`."""
        now = self.state
        rows = now["rows"][:, machines]
        believed = state_of(self.fleet.believed(rows))
        if self.misjudging is not None:
            moments = self.period * now["age"][machines]
            believed = self.misjudging(believed, moments, now["misjudged"][machines])
        acceleration = self.fleet.angular_acceleration(rows)
        return racing_observation(
            self.track,
            believed,
            state_of(rows),
            acceleration,
            now["target"][machines],
            now["previous"][machines],
        )

    def measures(self) -> dict[str, float]:
        """Return gates passed and crashes, each per second of one machine's flight."""
        gates, crashes, steps = self.state["counts"].tolist()
        self.state["counts"].zero_()
        seconds = max(steps, 1.0) * self.period
        return {"gates_per_second": gates / seconds, "crashes_per_second": crashes / seconds}


def commanded(action: Tensor, settings: Flying, gravity: float) -> Tensor:
    """Return collective thrust over mass and body rates, (batch, 4) m/s² and rad/s; an action of zero hovers.

    Args:
        action: (batch, 4) within ±1.
        settings: the greatest thrust and rates.
        gravity: m/s².
    """
    thrust = (gravity + (settings.thrust - gravity) * action[:, :1]).clamp_min(0.0)
    return torch.cat([thrust, settings.rate * action[:, 1:3], settings.yaw_rate * action[:, 3:]], dim=-1)
