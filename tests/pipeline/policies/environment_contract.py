"""What every environment keeps to: one set of checks for the whole family."""

import torch

from simgap.policies.environment import Environment, Observation, Transition


def check_contract(environment: Environment, steps: int = 50) -> None:
    """Fly, drive or push with random actions and check all that the contract promises."""
    _check_shapes(environment, environment.start(3))
    first = _walk(environment, steps, seed=5)
    environment.start(3)
    _same(_walk(environment, steps, seed=5), first)
    _check_ends(environment, first)
    _check_resumption(environment, steps)


def _walk(environment: Environment, steps: int, seed: int) -> list[Transition]:
    random = torch.Generator(environment.device).manual_seed(seed)
    shape = (environment.batch, environment.action_size)
    transitions = []
    for _ in range(steps):
        action = 3.0 * torch.randn(shape, generator=random, device=environment.device)
        transitions.append(environment.step(action))
    return transitions


def _check_shapes(environment: Environment, seen: Observation) -> None:
    assert seen.policy.shape == (environment.batch, environment.observation_size)
    assert seen.privileged.shape == (environment.batch, environment.privileged_size)
    assert seen.policy.dtype == seen.privileged.dtype == torch.float32
    assert environment.period > 0


def _check_ends(environment: Environment, transitions: list[Transition]) -> None:
    age = torch.zeros(environment.batch, dtype=torch.int64, device=environment.device)
    for transition in transitions:
        _check_shapes(environment, transition.reached)
        _check_shapes(environment, transition.observation)
        assert transition.reward.shape == (environment.batch,)
        assert bool(transition.reward.isfinite().all())
        assert bool(transition.observation.policy.isfinite().all())
        assert not bool((transition.terminated & transition.truncated).any())
        age += 1
        ended = transition.terminated | transition.truncated
        assert bool(
            (transition.truncated == ((age >= environment.episode_steps) & ~transition.terminated)).all()
        )
        assert torch.equal(transition.observation.policy[~ended], transition.reached.policy[~ended])
        assert torch.equal(transition.observation.privileged[~ended], transition.reached.privileged[~ended])
        age[ended] = 0


def _check_resumption(environment: Environment, steps: int) -> None:
    environment.start(4)
    _walk(environment, steps, seed=6)
    snapshot = environment.snapshot()
    ahead = _walk(environment, steps, seed=7)
    environment.resume(snapshot)
    _same(_walk(environment, steps, seed=7), ahead)


def _same(found: list[Transition], expected: list[Transition]) -> None:
    for one, other in zip(found, expected, strict=True):
        assert torch.equal(one.reward, other.reward)
        assert torch.equal(one.observation.policy, other.observation.policy)
        assert torch.equal(one.observation.privileged, other.observation.privileged)
        assert torch.equal(one.terminated, other.terminated)
        assert torch.equal(one.truncated, other.truncated)
