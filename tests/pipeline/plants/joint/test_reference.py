import numpy as np
import pytest

from simgap.plants.joint.case import REFERENCES, JointCase
from simgap.plants.joint.reference import names, references

TIMES = np.arange(-500, 6001) * 1e-3


@pytest.mark.parametrize("name", REFERENCES)
def test_references_stay_within_their_limits(name):
    case = JointCase(references=[name], runs=3, duration=6.0)
    position, velocity, acceleration = references(case, TIMES, np.random.default_rng(2))
    if name != "one_way":
        assert np.abs(position).max() <= case.amplitude * (1 + 1e-9)
    assert np.abs(velocity).max() <= case.velocity * (1 + 1e-9)
    assert np.abs(acceleration).max() <= case.acceleration * (1 + 1e-9)
    assert np.ptp(position, axis=0).min() > 0


def test_derivatives_are_those_of_the_position():
    case = JointCase(runs=4, duration=6.0)
    position, velocity, _ = references(case, TIMES, np.random.default_rng(2))
    moved = np.cumsum(0.5 * (velocity[1:] + velocity[:-1]), axis=0) * 1e-3
    np.testing.assert_allclose(position[1:] - position[0], moved, atol=1e-3 * case.amplitude)


def test_gentle_and_wild_runs_of_every_kind():
    case = JointCase(runs=8, duration=6.0)
    assert [name.split("_")[0] for name in names(case)] == case.references * 2
    velocity = references(case, TIMES, np.random.default_rng(2))[1]
    assert np.abs(velocity).max(axis=0).std() > 0


def test_one_way_never_turns_back():
    case = JointCase(references=["one_way"], runs=2, duration=6.0)
    velocity = references(case, TIMES, np.random.default_rng(2))[1]
    assert (velocity > 0).all()


def test_creeping_is_slow():
    case = JointCase(references=["creep"], runs=1, duration=6.0)
    velocity = references(case, TIMES, np.random.default_rng(2))[1]
    assert 0.01 * case.velocity < np.abs(velocity).max() < 0.05 * case.velocity
