"""Stretches that go on in one another are joined, and nothing else is."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.effects.chain import chains_of

STEP = 0.01


def stretches(run: int, first: int, count: int, samples: int, margin: int) -> dict[str, torch.Tensor]:
    """Cut a recording whose signal is its own sample number, as `cut_blocks` does."""
    length = samples + 2 * margin
    starts = first + torch.arange(count)[:, None] * samples
    number = (starts + torch.arange(length) - margin).double()
    return {
        "number": number,
        "elapsed": number * STEP,
        "run_number": torch.full_like(number, float(run)),
    }


def together(*parts: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    return {name: torch.cat([part[name] for part in parts]) for name in parts[0]}


@given(
    count=st.integers(1, 6), samples=st.integers(3, 20), margin=st.integers(1, 10), seed=st.integers(0, 99)
)
def test_a_run_in_any_order_is_one_chain_and_comes_back_as_it_was(count, samples, margin, seed):
    cut = stretches(0, 0, count, samples, margin)
    mixed = torch.randperm(count, generator=torch.Generator().manual_seed(seed))
    signals = {name: series[mixed] for name, series in cut.items()}
    chains = chains_of(signals, STEP, 9)
    joined = chains.joined(signals["number"])
    assert joined.shape == (1, count * samples + 2 * margin)
    torch.testing.assert_close(torch.diff(joined[0]), torch.ones(joined.shape[1] - 1).double())
    torch.testing.assert_close(chains.parted(joined), signals["number"])


def test_another_run_and_a_gap_break_a_chain():
    signals = together(stretches(0, 0, 3, 10, 4), stretches(0, 100, 2, 10, 4), stretches(1, 0, 2, 10, 4))
    chains = chains_of(signals, STEP, 9)
    assert sorted(torch.bincount(chains.chain).tolist()) == [2, 2, 3]
    torch.testing.assert_close(chains.parted(chains.joined(signals["number"])), signals["number"])


def test_a_gap_that_held_margins_bridge_breaks_a_chain_too():
    """Before and after a gap the margins hold the last and the first value, in time as in all else."""
    signals = together(stretches(0, 0, 2, 10, 4), stretches(0, 25, 2, 10, 4))
    for row, (least, most) in enumerate([(0, 19), (0, 19), (25, 44), (25, 44)]):
        for name, unit in (("number", 1.0), ("elapsed", STEP)):
            signals[name][row] = signals[name][row].clamp(least * unit, most * unit)
    assert chains_of(signals, STEP, 9).chain.tolist() == [0, 0, 1, 1]


def test_no_more_are_joined_than_asked_for():
    chains = chains_of(stretches(0, 0, 5, 10, 4), STEP, 2)
    assert chains.chain.tolist() == [0, 0, 1, 1, 2]
    assert chains.recorded.sum(1).tolist() == [28, 28, 18]


@pytest.mark.parametrize("missing", ["run_number", "elapsed"])
def test_what_is_not_known_to_go_on_starts_anew(missing):
    signals = stretches(0, 0, 3, 10, 4)
    del signals[missing]
    chains = chains_of(signals, STEP, 9)
    assert chains.chain.tolist() == [0, 1, 2]
    torch.testing.assert_close(chains.joined(signals["number"]), signals["number"])
