"""Rewards of a motion profile."""

from torch import Tensor

from simgap.policies.profile.settings import Profile


def step_reward(
    task: Profile,
    made: Tensor,
    velocity: Tensor,
    wanted: Tensor,
    voltage: Tensor,
    before: Tensor,
) -> Tensor:
    """Return the reward of a step within an episode, (batch,).

    Progress is rewarded. Unavailable voltage, energy, differences between wheels, voltage steps and time are penalised.

    Args:
        task: with the weights.
        made: distance to the target before less that after, (batch,) m.
        velocity: of the wheels after the step, (batch, wheels) m/s.
        wanted: voltage that the feedforward asked for, (batch, wheels) V.
        voltage: that was applied, (batch, wheels) V.
        before: that was applied in the step before, (batch, wheels) V.
    """
    weights, limit = task.weights, task.voltage_limit
    missing = ((wanted - voltage).abs() / limit).clamp(max=1.0).mean(-1)
    return (
        weights.progress * made
        - weights.over_voltage * missing
        - weights.energy * (voltage / limit).square().mean(-1)
        - weights.consistency * velocity.std(-1) / task.speed_limit
        - weights.smoothing * ((voltage - before).abs() / limit).mean(-1)
        - weights.guidance
    )


def final_reward(task: Profile, arrived: Tensor, failed: Tensor, speed: Tensor) -> Tensor:
    """Return the reward at the end of an episode, and zero elsewhere, (batch,).

    Args:
        task: with the weights.
        arrived: where it ends well, (batch,) bool.
        failed: where it ends badly, (batch,) bool.
        speed: (batch,) m/s, without sign.
    """
    weights = task.weights
    end = weights.arrival * arrived + weights.failure * failed
    return end + weights.final_speed * speed * (arrived | failed)
