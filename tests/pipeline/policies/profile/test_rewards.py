from dataclasses import replace

import pytest
import torch

from simgap.policies.profile.rewards import final_reward, step_reward
from simgap.policies.profile.settings import Profile, Weights

NOTHING = Weights(**dict.fromkeys(vars(Weights()), 0.0))


def reward(**changed):
    """The reward of one step at half speed on the way, with only some weights."""
    weights = {key: changed.pop(key) for key in list(changed) if key in vars(NOTHING)}
    still = torch.zeros(1, 4)
    step = {
        "made": torch.tensor([0.01]),
        "velocity": still + 1.5,
        "wanted": still + 6.0,
        "voltage": still + 6.0,
        "before": still + 6.0,
    }
    step |= {key: still + torch.as_tensor(value) for key, value in changed.items()}
    return float(step_reward(Profile(weights=replace(NOTHING, **weights)), **step))


def test_progress_earns_ten_per_metre():
    assert reward(progress=10.0) == pytest.approx(0.1)


def test_a_voltage_that_cannot_be_had_costs_its_excess_over_the_limit():
    assert reward(over_voltage=1.0, wanted=6.0) == 0.0
    assert reward(over_voltage=1.0, wanted=9.0) == pytest.approx(-0.25)
    assert reward(over_voltage=1.0, wanted=900.0) == pytest.approx(-1.0)


def test_energy_goes_with_the_square_of_the_voltage():
    assert reward(energy=1.0) == pytest.approx(-0.25)


def test_wheels_that_agree_cost_nothing():
    assert reward(consistency=1.0) == 0.0
    assert reward(consistency=1.0, velocity=[1.0, 2.0, 1.0, 2.0]) < 0.0


def test_a_jump_of_the_voltage_costs_its_size():
    assert reward(smoothing=1.0) == 0.0
    assert reward(smoothing=1.0, before=-6.0) == pytest.approx(-1.0)


def test_every_step_costs_the_same():
    assert reward(guidance=1.0) == pytest.approx(-1.0)


def test_the_end_is_worth_what_was_published():
    """+1000 for arriving, −100 for failing, −50·|v| for the speed that is left."""
    yes, no = torch.tensor([True]), torch.tensor([False])
    speed = torch.tensor([0.5])
    assert float(final_reward(Profile(), yes, no, speed)) == 1000.0 - 25.0
    assert float(final_reward(Profile(), no, yes, speed)) == -100.0 - 25.0
    assert float(final_reward(Profile(), no, no, speed)) == 0.0
