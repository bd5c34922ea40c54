from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.errors import InputError
from simgap.gates.settings import GateSettings, TrackSettings
from simgap.gates.track import track_from
from simgap.physics import rotations
from simgap.policies.racing.passage import passage
from simgap.policies.racing.time_optimal import Limits, optimal_lap
from tests.pipeline.gates.tracks import track_named

LIMITS = Limits(thrust=30.0, rate=10.0, yaw_rate=4.0)


@pytest.fixture(scope="module")
def lap():
    return optimal_lap(track_named("tiny"), LIMITS, gravity=9.81, nodes=8)


def test_the_lap_passes_every_gate_with_the_margin(lap):
    track = track_named("tiny")
    position = torch.tensor(lap.states[:, :3], dtype=torch.float32)
    for gate, node in enumerate(lap.gates):
        found = passage(
            track,
            position[node - 1 : node],
            position[node : node + 1] + 1e-3 * track.axes[gate, 0],
            torch.tensor([gate]),
        )
        assert bool(found.passed)
        assert float(found.margin) >= track.clearance + LIMITS.margin - 1e-2


def test_the_lap_keeps_the_limits_and_ends_as_it_began(lap):
    assert lap.inputs[:, 0].min() >= -1e-6
    assert lap.inputs[:, 0].max() <= LIMITS.thrust + 1e-6
    assert np.abs(lap.states[:, 10:12]).max() <= LIMITS.rate + 1e-6
    assert np.abs(lap.states[:, 12]).max() <= LIMITS.yaw_rate + 1e-6
    assert np.allclose(np.linalg.norm(lap.states[:, 3:7], axis=1), 1.0, atol=1e-6)
    moving = [*range(3), *range(7, 13)]
    assert np.allclose(lap.states[0, moving], lap.states[-1, moving], atol=1e-5)
    assert abs(lap.states[0, 3:7] @ lap.states[-1, 3:7]) == pytest.approx(1.0, abs=1e-5)


def test_the_lap_obeys_newton(lap):
    """Velocities differ by the integral of thrust and gravity, taken along the attitudes between the nodes."""
    step = np.diff(lap.times)
    attitude = torch.tensor(lap.states[:, 3:7])
    axis = rotations.rotate(
        attitude, torch.tensor([0.0, 0.0, 1.0], dtype=torch.float64).expand(len(attitude), 3)
    )
    middle = 0.5 * (axis[1:] + axis[:-1]).numpy()  # the trapezoid's rule, hence the tolerance
    gained = step[:, None] * (lap.inputs[:, :1] * middle + np.array([0.0, 0.0, -9.81]))
    assert np.allclose(np.diff(lap.states[:, 7:10], axis=0), gained, atol=0.1)


def test_a_circle_is_flown_as_fast_as_the_thrust_allows(lap):
    """Level on a circle of radius r, v² / r = √(thrust² − gravity²); a shorter way inside the gates is faster."""
    half = 1.5 - 0.15 - LIMITS.margin
    turning = np.sqrt(LIMITS.thrust**2 - 9.81**2)
    outer, inner = (2.0 * np.pi * np.sqrt(radius / turning) for radius in (4.0, 4.0 - half))
    assert 0.9 * inner < lap.duration < outer


def test_more_thrust_makes_a_faster_lap(lap):
    weaker = optimal_lap(track_named("tiny"), replace(LIMITS, thrust=20.0), gravity=9.81, nodes=8)
    assert weaker.duration > 1.1 * lap.duration


def test_a_lap_that_cannot_be_flown_is_refused():
    gates = [GateSettings([0.0, 0.0, 2.0], [1.0, 0.0]), GateSettings([3.0, 0.0, 2.0], [-1.0, 0.0])]
    track = track_from(TrackSettings("pit", gates, box=[[-5.0, -5.0, 0.0], [5.0, 5.0, 5.0]]))
    with pytest.raises(InputError, match="no time-optimal lap"):
        optimal_lap(track, replace(LIMITS, thrust=5.0), gravity=9.81, nodes=4)  # cannot carry its weight
