"""Results that are used again where nothing has changed."""

import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import Tensor

from simgap.physics.latest import Latest
from simgap.physics.tracing import traced_operations

LONG = 2_000


def doubled(latest: Latest[Tensor], series: Tensor, factor: Tensor, made: list[float]) -> Tensor:
    """Return a product from memory or anew; put down the factor where it is made."""

    def make() -> Tensor:
        made.append(float(factor))
        return factor * series

    return latest.of((series, factor), make)


@given(st.lists(st.integers(1, 12), min_size=1, max_size=30))
def test_every_result_is_that_of_its_arguments(factors: list[int]) -> None:
    """Whatever was asked for before."""
    latest, series = Latest[Tensor](), torch.linspace(-1.0, 1.0, LONG)
    for factor in factors:
        found = doubled(latest, series, torch.tensor(float(factor)), [])
        assert torch.equal(found, factor * series)


def test_equal_values_are_worked_out_once_until_others_have_come() -> None:
    """Copies count as the same; of more arguments than are kept the first is forgotten."""
    latest, series, made = Latest[Tensor](), torch.linspace(-1.0, 1.0, LONG), list[float]()
    for factor in (1.0, 1.0, 2.0, 1.0):
        doubled(latest, series.clone(), torch.tensor(factor), made)
    assert made == [1.0, 2.0]
    for factor in (3.0, 4.0, 5.0, 6.0, 7.0, 1.0):
        doubled(latest, series, torch.tensor(factor), made)
    assert made == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 1.0]


def test_changes_in_place_are_seen() -> None:
    """What is kept is a copy of the arguments."""
    latest, series = Latest[Tensor](), torch.ones(LONG)
    doubled(latest, series, torch.tensor(2.0), [])
    series[7] = 5.0
    assert doubled(latest, series, torch.tensor(2.0), [])[7] == 10.0


def test_a_result_has_the_precision_of_its_arguments() -> None:
    """Numbers that both precisions hold count as equal to the library."""
    latest, factor = Latest[Tensor](), torch.tensor(2.0)
    for precision in (torch.float32, torch.float64):
        assert doubled(latest, torch.ones(LONG, dtype=precision), factor, []).dtype == precision


def test_gradients_traces_and_short_series_are_worked_out_anew() -> None:
    """A result from memory has no operations behind it, and comparing a short series takes as long as the work."""
    latest, made = Latest[Tensor](), list[float]()
    series, factor = torch.ones(LONG), torch.tensor(2.0)
    doubled(latest, series, factor, made)
    followed = series.clone().requires_grad_()
    doubled(latest, followed, factor, made).sum().backward()
    assert followed.grad is not None
    assert torch.equal(followed.grad, 2.0 * series)
    with traced_operations():
        doubled(latest, series, factor, made)
    doubled(latest, series[:10], factor, made)
    doubled(latest, series[:10], factor, made)
    assert len(made) == 5
