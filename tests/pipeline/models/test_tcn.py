"""Convolutions that look back only, over as long a past as their dilations say."""

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import nn

from simgap.errors import InputError
from simgap.models.layouts import layout_of
from simgap.models.registry import model_settings
from simgap.models.tcn import TemporalConvolutionModel, TemporalConvolutionSettings
from simgap.runner.compose import compose
from tests.pipeline.models import learnable


def _network(kernel: int, blocks: int) -> nn.Sequential:
    settings = TemporalConvolutionSettings(hidden=[4] * blocks, dropout=[], kernel=kernel, sequence_length=64)
    model = learnable.new_model(
        "tcn", learnable.linear_joint(), hidden=[4] * blocks, dropout=[], kernel=kernel
    )
    assert isinstance(model, TemporalConvolutionModel)
    torch.manual_seed(0)
    network = TemporalConvolutionModel(model.layout, settings, 0.01).network.double().eval()
    assert isinstance(network, nn.Sequential)
    return network


@given(kernel=st.integers(1, 4), blocks=st.integers(1, 4), touched=st.integers(0, 63))
def test_a_sample_moves_only_what_comes_after_it_and_within_reach(kernel, blocks, touched):
    """Reach: two convolutions of (kernel − 1)·2ⁿ samples in block n."""
    network = _network(kernel, blocks)
    convolutions = network[:-2]  # without the average and the head
    generator = torch.Generator().manual_seed(touched)
    features = next(m for m in network.modules() if isinstance(m, nn.Conv1d)).in_channels
    windows = torch.randn((1, 64, features), generator=generator, dtype=torch.float64)
    changed = windows.clone()
    changed[:, touched] += 1.0
    moved = (convolutions(changed) - convolutions(windows)).abs().amax((0, 1)).nonzero().squeeze(1)
    reach = 2 * (kernel - 1) * (2**blocks - 1)
    assert (moved >= touched).all()
    assert (moved <= touched + reach).all()


@pytest.mark.parametrize(
    ("key", "value"), [("kernel", 0), ("stem", 0), ("dense", [0]), ("dense_dropout", 1.0)]
)
def test_what_makes_no_network_is_refused(key, value):
    with pytest.raises(InputError, match=rf"model\.{key}"):
        learnable.new_model("tcn", learnable.linear_joint(), **{key: value})


def test_the_network_for_swerve_drives_is_the_published_one():
    values = dict(compose(["model=swerve/tcn"])["model"])
    layout = layout_of(learnable.swerve(), "all_steering")
    network = TemporalConvolutionModel(layout, model_settings(values), 0.02).network
    _, normalisation, pad, stem, *rest = network
    assert isinstance(normalisation, nn.BatchNorm1d)
    assert normalisation.num_features == 16  # velocity and voltage of eight motors
    assert isinstance(pad, nn.ConstantPad1d)
    assert (stem.in_channels, stem.out_channels) == (16, 64)
    dense = [layer for layer in rest if isinstance(layer, nn.Linear)]
    assert [layer.out_features for layer in dense] == [64, 32, 4]
    assert [layer.p for layer in rest if isinstance(layer, nn.Dropout)] == [0.3, 0.3]


@pytest.mark.parametrize("activated", [True, False])
def test_a_block_can_lower_what_it_passes_on_only_without_the_relu_before_the_sum(activated):
    settings = TemporalConvolutionSettings(hidden=[4], dropout=[], stem=4, activated=activated)
    model = TemporalConvolutionModel(layout_of(learnable.swerve(), "all_steering"), settings, 0.02)
    network = model.network.eval()
    place = next(n for n, layer in enumerate(network) if hasattr(layer, "body"))
    series = torch.rand(8, 4, 20)
    assert bool((network[place].body(series) >= 0.0).all()) == activated


def test_the_default_is_the_published_network():
    settings = model_settings({"name": "tcn"})
    assert isinstance(settings, TemporalConvolutionSettings)
    assert len(settings.hidden) == 6  # dilations 1, 2, 4, 8, 16, 32
    assert settings.dropouts() == [0.2] * 6
    assert settings.learning_rate == 3e-4
