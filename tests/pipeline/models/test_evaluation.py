"""Scores of models whose errors are known beforehand."""

import math

import pytest
import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel
from simgap.models.error_distribution import error_quantiles
from simgap.models.evaluation import rollout_errors, scored_starts
from simgap.models.joint_layout import JointLayout
from simgap.models.settings import ModelSettings
from simgap.models.step_scores import UNCORRECTED, NextValues, next_values, step_scores
from simgap.models.windows import Series, evenly

TIME_STEP = 0.1


class Constant(DynamicsModel):
    """Adds the same to the velocity at every step."""

    settings_class = ModelSettings

    def __init__(self, increment: float, length: int = 1) -> None:
        super().__init__(
            JointLayout(("effort",), sliding=True), ModelSettings(sequence_length=length), TIME_STEP
        )
        self.increment = increment

    def fit(self, train, validation, training, context=None) -> float:
        raise NotImplementedError

    def increments(self, features: Tensor) -> Tensor:
        return torch.full((len(features), 1), self.increment, dtype=features.dtype)

    def tensors(self):
        raise NotImplementedError

    def restore(self, tensors):
        raise NotImplementedError


def moving(velocity: Tensor, *bounds: tuple[int, int]) -> Series:
    """Return a mass with these velocities, cut into segments."""
    position = TIME_STEP * torch.cumsum(velocity, 0)
    return Series(
        states=torch.stack([position, velocity], dim=1),
        actions=torch.zeros(len(velocity), 1, dtype=torch.float64),
        bounds=torch.tensor(bounds or [(0, len(velocity))]),
        time_step=TIME_STEP,
    )


def speeding(samples: int) -> Tensor:
    return torch.arange(samples, dtype=torch.float64)


def test_errors_grow_and_add_up_as_the_model_says():
    errors = rollout_errors(Constant(0.75), moving(speeding(20)), [4, 1], most=100)["velocity"]
    assert list(errors) == ["h1", "h4", "sum"]
    assert errors["h1"] == pytest.approx({"model": 0.25, "naive": 1.0})
    assert errors["h4"] == pytest.approx({"model": 1.0, "naive": 4.0})
    assert errors["sum"] == pytest.approx({"model": 0.25 * 10, "naive": 10.0})


def test_quantiles_are_those_of_the_errors_of_the_windows():
    """Of a velocity k² that is kept as it is: 2·k + 1 after one step, 4·k + 4 after two, from window k."""
    series = moving(speeding(13) ** 2)
    found = error_quantiles(Constant(0.0), series, [1, 2], [0.0, 0.5, 1.0], most=100)["velocity"]
    assert found["h1"] == pytest.approx({"q0": 1.0, "q50": 11.0, "q100": 21.0})
    assert found["h2"] == pytest.approx({"q0": 4.0, "q50": 24.0, "q100": 44.0})


def test_what_is_no_share_is_refused():
    with pytest.raises(InputError, match=r"train\.quantiles"):
        error_quantiles(Constant(0.0), moving(speeding(13)), [1], [50.0], most=100)


def test_a_horizon_longer_than_every_segment_is_left_out():
    errors = rollout_errors(Constant(1.0), moving(speeding(20), (0, 8), (8, 20)), [1, 10, 20], most=100)
    assert list(errors["velocity"]) == ["h1", "h10", "sum"]
    assert errors["velocity"]["sum"]["naive"] == pytest.approx(sum(range(1, 11)))


@pytest.mark.parametrize("history", [7, 20])
def test_models_of_any_window_are_scored_on_the_same_samples(history):
    series = moving(speeding(60), (0, 25), (25, 60))
    first = [
        (scored_starts(Constant(0.0, length), series, 3, history) + length).tolist() for length in (1, 4, 7)
    ]
    assert first[0] == first[1] == first[2]
    assert first[0][0] == history
    assert 25 + history in first[0]
    assert max(first[0]) == 60 - 3


def test_a_window_longer_than_the_history_is_never_cut():
    starts = scored_starts(Constant(0.0, 10), moving(speeding(30)), 2, history=5)
    assert starts.tolist() == list(range(30 - 12 + 1))


def test_what_is_too_short_is_refused():
    series = moving(speeding(20))
    with pytest.raises(InputError, match=r"train\.horizons: no held-out segment is long enough"):
        rollout_errors(Constant(0.0), series, [5], most=100, history=16)
    with pytest.raises(InputError, match=r"model\.sequence_length: no held-out segment is long enough"):
        next_values(Constant(0.0, 20), {"": series})


def test_scores_of_one_step_are_those_of_their_definitions():
    generator = torch.Generator().manual_seed(0)
    velocity = torch.cumsum(torch.randn(500, generator=generator, dtype=torch.float64), 0)
    scores = step_scores(next_values(Constant(0.5), {"": moving(velocity)}))
    assert set(scores) == {"velocity"}
    change, following = velocity.diff(), velocity[1:]
    squared = (change - 0.5).square()
    expected = {
        "mse": squared.mean(),
        "mae": (change - 0.5).abs().mean(),
        "r_squared": 1 - squared.mean() / following.var(correction=0),
        "increment_r_squared": 1 - squared.mean() / change.var(correction=0),
        "correlation": torch.corrcoef(torch.stack([velocity[:-1] + 0.5, following]))[0, 1],
    }
    assert scores["velocity"] == pytest.approx({key: float(value) for key, value in expected.items()})


def test_a_perfect_model_scores_one():
    score = step_scores(next_values(Constant(2.0), {"": moving(2.0 * speeding(50))}))["velocity"]
    assert score["mse"] == pytest.approx(0.0, abs=1e-20)
    assert [score["r_squared"], score["correlation"]] == pytest.approx([1.0, 1.0])
    assert math.isnan(
        score["increment_r_squared"]
    )  # all increments are alike: nothing is there to be explained


def test_the_mean_as_prediction_scores_zero_and_a_correction_is_scored_beside_what_was_before():
    true = speeding(11)
    exact, mean = NextValues(true, true, true), NextValues(true, torch.full_like(true, 5.0), true)
    scores = step_scores({"velocity": exact}, {"velocity": mean})["velocity"]
    assert [scores["mse"], scores["mae"], scores["r_squared"]] == [0.0, 0.0, 1.0]
    assert scores["mse_uncorrected"] == pytest.approx(10.0)
    assert scores["mae_uncorrected"] == pytest.approx(30.0 / 11.0)
    assert scores["r_squared_uncorrected"] == pytest.approx(0.0)
    assert set(scores) == {
        f"{name}{end}" for name in step_scores({"v": exact})["v"] for end in ("", UNCORRECTED)
    }


def test_machines_of_one_kind_are_told_apart_by_their_suffix():
    machines = {"_1": moving(speeding(20)), "_2": moving(3.0 * speeding(20))}
    values = next_values(Constant(1.0), machines)
    assert {name: set(own.residuals.tolist()) for name, own in values.items()} == {
        "velocity_1": {0.0},
        "velocity_2": {2.0},
    }


def test_starts_are_thinned_evenly():
    starts = torch.arange(100)
    assert evenly(starts, 100).tolist() == list(range(100))
    assert evenly(starts, 4).tolist() == [0, 33, 66, 99]
