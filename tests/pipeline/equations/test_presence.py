"""Where an effect acts: blocks, entries of the diagnosis, sentences."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.equations.presence import Presence, beginning, ending
from simgap.simulation.blocks import Blocks

RUNS = ("a", "b", "c", "d")


def blocks_of(lengths: list[int]) -> Blocks:
    """Return blocks of 2 s that hold nothing, some of each run."""
    run = torch.tensor([index for index, length in enumerate(lengths) for _ in range(length)])
    start = torch.tensor([2.0 * block for length in lengths for block in range(length)], dtype=torch.float64)
    return Blocks({}, run, RUNS[: len(lengths)], start, 0.01, 10, 200)


@given(
    st.lists(st.integers(0, 4), min_size=1, max_size=4).filter(lambda lengths: sum(lengths) > 1), st.data()
)
def test_a_beginning_and_an_end_at_one_place_divide_the_blocks(lengths, data):
    blocks = blocks_of(lengths)
    first = data.draw(st.integers(1, len(blocks) - 1))
    after, before = beginning(blocks, first).acts(blocks), ending(blocks, first).acts(blocks)
    assert after.tolist() == [place >= first for place in range(len(blocks))]
    assert torch.equal(before, ~after)


def test_a_run_without_fitted_blocks_belongs_to_what_begins_after_it():
    blocks = blocks_of([2, 0, 2, 0])
    assert beginning(blocks, 2).runs == ("c", "d")
    assert ending(blocks, 2).runs == ("a",)


@pytest.mark.parametrize(
    ("presence", "entries", "sentence"),
    [
        (Presence(("x",), ("b", "c", "d")), ["b", "c", "d"], "It acts from b on."),
        (Presence(("x",), ("a", "c")), ["a", "c"], "It acts in a and c only."),
        (Presence(("x",), ("d",)), ["d"], "It acts in d only."),
        (
            Presence(("x",), ("c", "d"), since=12.5),
            [{"run": "c", "from": 12.5}, "d"],
            "It acts from 12.5 s of c on.",
        ),
        (
            Presence(("x",), ("a", "b"), until=4.0),
            ["a", {"run": "b", "until": 4.0}],
            "It acts until 4 s of b.",
        ),
    ],
)
def test_a_diagnosis_lists_runs_and_says_where_an_effect_acts(presence, entries, sentence):
    assert presence.entries == entries
    assert presence.sentence(RUNS) == sentence
