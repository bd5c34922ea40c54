import numpy as np
import pandas as pd
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as some

from simgap.errors import InputError
from simgap.physics import rotations
from simgap.policies.residual.beliefs import (
    FEATURES,
    RESIDUALS,
    misjudged,
    recorded_beliefs,
    state_features,
    with_residual,
)


def states(seed, count=5):
    random = torch.Generator().manual_seed(seed)
    part = torch.randn(count, 13, generator=random, dtype=torch.float64)
    position, attitude, velocity, rate = part.split([3, 4, 3, 3], dim=-1)
    attitude = rotations.normalize(attitude)
    return {"position": position, "attitude": attitude, "velocity": velocity, "body_rate": rate}


@given(some.integers(0, 1000))
def test_a_belief_is_the_state_with_its_residual(seed):
    truth = states(seed)
    residual = (
        2.0 * torch.rand(5, len(RESIDUALS), generator=torch.Generator().manual_seed(seed)).double() - 1.0
    )
    belief = with_residual(truth, residual)
    torch.testing.assert_close(misjudged(truth, belief), residual, rtol=0, atol=1e-6)


def test_features_do_not_jump_where_quaternions_do():
    state = states(0)
    other = {**state, "attitude": -state["attitude"]}
    assert state_features(state).shape == (5, FEATURES)
    torch.testing.assert_close(state_features(other), state_features(state))


def recorded(count=50):
    state = states(1, count)
    belief = with_residual(state, torch.full((count, 9), 0.1, dtype=torch.float64))
    axes = {"position": "xyz", "attitude": "wxyz", "velocity": "xyz", "body_rate": "xyz"}
    columns = {
        f"{stem}{name}_{axis}": values[name][:, place].numpy()
        for stem, values in (("", state), ("estimate_", belief))
        for name, letters in axes.items()
        for place, axis in enumerate(letters)
    }
    times = {"run": np.where(np.arange(count) < count // 2, "a", "b"), "t": 3.0 + 0.1 * np.arange(count)}
    return pd.DataFrame(times | columns)


def test_residuals_are_read_from_a_recording_with_gaps():
    frame = recorded()
    frame.loc[3, "estimate_velocity_x"] = np.nan
    features, residual, course = recorded_beliefs(frame, samples=40)
    assert features.shape == (40, FEATURES)
    assert course.flight.tolist() == sorted(course.flight.tolist())
    assert course.moment[course.flight.diff(prepend=torch.tensor([-1])) > 0].tolist() == [0.0, 0.0]
    assert float(course.moment.max()) == pytest.approx(2.4)
    torch.testing.assert_close(residual, torch.full((40, 9), 0.1, dtype=torch.float64), rtol=0, atol=1e-9)


def test_a_recording_without_estimates_is_refused():
    with pytest.raises(InputError, match="estimate_position_x"):
        recorded_beliefs(recorded().drop(columns="estimate_position_x"), 10)
    with pytest.raises(InputError, match="record more"):
        recorded_beliefs(recorded(5), 10)
