"""Initial states of episodes: states of passing a gate, perturbed within bounds.

The states of each gate are ordered: slow ones, planned ones of the time-optimal lap, and recorded ones.

A perturbed machine always starts behind its gate. In front of it and off the centre of the opening, it would hit the
frame.
"""

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.gates.track import Track
from simgap.physics import rotations
from simgap.policies.racing.flying import PARTS, STATE
from simgap.policies.racing.settings import Starts


def first_starts(track: Track, settings: Starts, planned: Tensor | None = None) -> Tensor:
    """Return states to start from before any machine has passed a gate, (gates, kept, 13).

    The machine is in the middle of the gate, level, and flies out of it; planned states are those of the plan.

    Args:
        track: its gates.
        settings: how many states there are, and which share of them is planned.
        planned: states after each gate, (gates, states, 13); None: the plan has no share.

    Raises:
        InputError: when no place is left for states that are seen later.
    """
    slow, staying = _staying(settings)
    if not 0 <= slow <= staying < settings.kept:
        raise InputError(
            "leave no place for states that are seen later",
            "starts.slow and starts.planned",
            "choose shares of 0 to 0.9 together",
        )
    state = track.centres.new_zeros(len(track), STATE)
    yaw = torch.atan2(track.axes[:, 0, 1], track.axes[:, 0, 0])
    vertical = torch.nn.functional.pad(yaw[:, None], (2, 0))
    state[:, PARTS["position"]] = track.centres
    state[:, PARTS["attitude"]] = rotations.from_rotation_vector(vertical)
    state[:, PARTS["velocity"]] = settings.speed * track.axes[:, 0]
    starts = state[:, None].repeat(1, settings.kept, 1)
    if planned is not None:
        places = torch.arange(slow, staying, device=starts.device)
        starts[:, places] = planned.to(starts)[:, (places - slow) % planned.shape[1]]
    return starts


def _staying(settings: Starts) -> tuple[int, int]:
    """Return how many states of a gate stay slow, and how many stay at all."""
    slow = round(settings.slow * settings.kept)
    return slow, slow + round(settings.planned * settings.kept)


def keep(
    starts: Tensor,
    gates: Tensor,
    states: Tensor,
    settings: Starts,
    generator: torch.Generator,
    passed: Tensor | None = None,
) -> None:
    """Put states in which gates were passed in place of earlier ones, which are drawn; slow and planned ones stay.

    Args:
        starts: (gates, kept, 13), changed in place.
        gates: of some machines, (machines,).
        states: (machines, 13).
        settings: how many stay.
        generator: of the draws.
        passed: which of the machines have passed their gates, (machines,) bool; None: all of them.
    """
    if not len(gates):
        return
    flat, kept = starts.flatten(0, 1), starts.shape[1]
    _, staying = _staying(settings)
    places = torch.randint(staying, kept, gates.shape, generator=generator, device=starts.device)
    # Of passes that drew one place the last counts. What was not passed goes to a place beyond all of them.
    slots = gates * kept + places
    slots = slots if passed is None else slots.masked_fill(~passed, len(flat))
    order = torch.arange(len(slots), device=slots.device)
    last = torch.full_like(slots[:1], -1).repeat(len(flat) + 1).scatter_reduce_(0, slots, order, "amax")[:-1]
    flat.copy_(torch.where((last >= 0)[:, None], states[last.clamp_min(0)], flat))


def drawn_start(
    starts: Tensor, count: int, track: Track, settings: Starts, generator: torch.Generator
) -> tuple[Tensor, Tensor]:
    """Return gates that were passed (count,), drawn evenly, and states (count, 13) perturbed within bounds."""
    gates = torch.randint(starts.shape[0], (count,), generator=generator, device=starts.device)
    places = torch.randint(starts.shape[1], (count,), generator=generator, device=starts.device)
    return gates, perturbed(starts[gates, places], gates, track, settings, generator)


def perturbed(
    state: Tensor, gates: Tensor, track: Track, settings: Starts, generator: torch.Generator
) -> Tensor:
    """Return states with each part moved within its bounds.

    Args:
        state: (batch, 13).
        gates: that have been passed, (batch,).
        track: to which they belong.
        settings: the bounds.
        generator: of the draws.
    """
    draw = torch.rand(len(state), 12, generator=generator, device=state.device) * 2.0 - 1.0
    position, attitude, velocity, rate = draw.split(3, dim=-1)
    turned = rotations.multiply(
        state[:, PARTS["attitude"]], rotations.from_rotation_vector(settings.attitude * attitude)
    )
    return torch.cat(
        [
            _beyond(track, gates, state[:, PARTS["position"]] + settings.position * position),
            rotations.normalize(turned),
            state[:, PARTS["velocity"]] + settings.velocity * velocity,
            state[:, PARTS["body_rate"]] + settings.body_rate * rate,
        ],
        dim=-1,
    )


def _beyond(track: Track, gates: Tensor, position: Tensor) -> Tensor:
    """Return positions (batch, 3), those on the near side of their gates mirrored to the far side."""
    axis = track.axes[gates, 0]
    depth = ((position - track.centres[gates]) * axis).sum(-1, keepdim=True)
    return position - 2.0 * depth.clamp_max(0.0) * axis
