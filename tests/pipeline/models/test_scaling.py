import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.models.scaling import SCALINGS, Scaler


@given(st.integers(0, 100), st.sampled_from(SCALINGS))
@settings(max_examples=20, deadline=None)
def test_undoing_gives_the_values_back(seed, scaling):
    generator = torch.Generator().manual_seed(seed)
    values = 5.0 + 3.0 * torch.randn(50, 3, generator=generator, dtype=torch.float64)
    scaler = Scaler.fit(values, scaling)
    assert torch.allclose(scaler.undo(scaler.apply(values)), values)


def test_a_constant_column_stays_finite():
    values = torch.full((10, 1), 4.0, dtype=torch.float64)
    for scaling in SCALINGS:
        assert Scaler.fit(values, scaling).apply(values).abs().max() == 0.0


def test_a_column_that_mostly_rests_is_not_blown_up():
    values = torch.zeros(100, 1, dtype=torch.float64)
    values[:10] = 1.0
    assert Scaler.fit(values, "robust").apply(values).abs().max() < 5.0
