import pytest
import torch
import yaml

from simgap.errors import InputError
from simgap.policies.networks import Critic, Gaussian
from simgap.policies.storage import (
    DESCRIPTION_FILE,
    TENSOR_FILE,
    Description,
    load_critic,
    load_policy,
    save_policy,
)

DESCRIPTION = Description(
    "racing", 5, 2, 0.01, [16, 16], 0.2, {"seed": 1}, "abc", "the last", {"return": 1.0}
)


@pytest.fixture
def saved(tmp_path):
    torch.manual_seed(0)
    gaussian = Gaussian(5, 2, [16, 16], 0.2, 0.5)
    save_policy(gaussian, DESCRIPTION, tmp_path)
    return gaussian, tmp_path


def test_a_policy_is_read_as_it_was_written(saved):
    gaussian, folder = saved
    read, description = load_policy(folder)
    assert description == DESCRIPTION
    observation = torch.randn(3, 5)
    for one, other in zip(read(observation), gaussian(observation), strict=True):
        assert torch.equal(one, other)


def test_the_same_policy_gives_the_same_bytes(saved, tmp_path):
    gaussian, folder = saved
    save_policy(gaussian, DESCRIPTION, tmp_path / "again")
    for file in (DESCRIPTION_FILE, TENSOR_FILE):
        assert (tmp_path / "again" / file).read_bytes() == (folder / file).read_bytes()


def test_a_policy_goes_on_only_with_its_own_critic(saved, tmp_path):
    gaussian, folder = saved
    with pytest.raises(InputError, match="no critic to go on with"):
        load_critic(Critic(5, 3, [16, 16], 0.2), folder)
    critic, other = Critic(5, 3, [16, 16], 0.2), Critic(5, 3, [16, 16], 0.2)
    save_policy(gaussian, DESCRIPTION, tmp_path / "both", critic)
    load_critic(other, tmp_path / "both")
    assert all(torch.equal(*pair) for pair in zip(other.parameters(), critic.parameters(), strict=True))
    with pytest.raises(InputError, match="does not hold the policy's numbers"):
        load_critic(Critic(5, 4, [16, 16], 0.2), tmp_path / "both")
    load_policy(tmp_path / "both")


def test_what_is_no_policy_is_refused_in_one_line(saved):
    _, folder = saved
    with pytest.raises(InputError, match="cannot be read"):
        load_policy(folder / "nowhere")
    document = yaml.safe_load((folder / DESCRIPTION_FILE).read_text())
    changed = {
        "schema": {**document, "schema": "other"},
        "description": {**document, "unknown": 1},
        "numbers": {**document, "hidden": [8, 8]},
    }
    for message, content in changed.items():
        (folder / DESCRIPTION_FILE).write_text(yaml.safe_dump(content))
        with pytest.raises(InputError, match=message):
            load_policy(folder)
    (folder / DESCRIPTION_FILE).write_text(yaml.safe_dump(document))
    (folder / TENSOR_FILE).write_bytes(b"other")
    with pytest.raises(InputError, match="belongs to"):
        load_policy(folder)
