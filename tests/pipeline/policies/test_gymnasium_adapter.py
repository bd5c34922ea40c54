import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from simgap.policies.gymnasium_adapter import GymnasiumEnvironment
from tests.pipeline.policies.point_mass import PointMass
from tests.pipeline.policies.racing.machines import racing


@pytest.mark.filterwarnings("ignore:.*Box observation space:UserWarning")
@pytest.mark.parametrize("make", [PointMass, racing], ids=["point mass", "racing"])
def test_gymnasium_finds_nothing_wrong(make):
    check_env(GymnasiumEnvironment(make(1)), skip_render_check=True)


def test_the_last_observation_of_an_episode_is_where_it_ended():
    environment = GymnasiumEnvironment(PointMass(1))
    environment.reset(seed=0)
    over, seen = False, np.zeros(2, np.float32)
    for _ in range(100):
        seen, _, over, _, _ = environment.step(np.ones(1, np.float32))
        if over:
            break
    assert over
    assert abs(float(seen[0])) > 4.0


def test_a_batch_is_refused():
    with pytest.raises(ValueError, match="one machine"):
        GymnasiumEnvironment(PointMass(2))
