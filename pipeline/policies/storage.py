"""A policy on disk: `policy.yaml` for people, `policy.safetensors` for numbers. Loading executes nothing.

Beside it stands the critic that it was trained with, where it is to be trained further.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from torch import nn

from simgap.artifacts.descriptions import (
    read_description,
    read_tensors,
    write_description,
    write_tensors,
)
from simgap.errors import InputError
from simgap.policies.networks import Critic, Gaussian

SCHEMA = "simgap.policy/1"
DESCRIPTION_FILE = "policy.yaml"
TENSOR_FILE = "policy.safetensors"
CRITIC_FILE = "critic.safetensors"
_SOURCE = "give the folder of a policy, as simgap train_policy writes it"
_REMEDY = "train the policy again"


@dataclass(frozen=True)
class Description:
    """What a policy is and where it comes from.

    Attributes:
        task: what it was trained for.
        observation_size: numbers that it sees.
        action_size: numbers of its action, each within ±1.
        period: between two actions, s.
        hidden: widths of its layers.
        slope: of LeakyReLU below zero.
        configuration: resolved, of the stage that trained it.
        simulator: SHA-256 of the simulator in which it was trained; empty for the platform's own dynamics.
        chosen_by: which of a training's policies this is.
        measures: means over the last tenth of its learning curve.
    """

    task: str
    observation_size: int
    action_size: int
    period: float
    hidden: list[int]
    slope: float
    configuration: dict[str, Any] = field(default_factory=dict)
    simulator: str = ""
    chosen_by: str = ""
    measures: dict[str, float] = field(default_factory=dict)


def save_policy(
    gaussian: Gaussian, description: Description, folder: Path, critic: Critic | None = None
) -> None:
    """Write a policy into a folder, and its critic if there is one; the same policy gives the same bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    document: dict[str, Any] = {"schema": SCHEMA, **asdict(description)}
    document["tensors"] = write_tensors(gaussian.state_dict(), folder / TENSOR_FILE)
    if critic is not None:
        document["critic"] = write_tensors(critic.state_dict(), folder / CRITIC_FILE)
    write_description(document, folder / DESCRIPTION_FILE)


def load_policy(folder: Path) -> tuple[Gaussian, Description]:
    """Read a policy that `save_policy` wrote.

    Raises:
        InputError: when a file is missing, is not what it should be, or does not fit the other.
    """
    document = _read(folder)
    stored = document.pop("tensors", {})
    for key in ("schema", "critic"):
        document.pop(key, None)
    try:
        description = Description(**document)
        sizes = (description.observation_size, description.action_size, description.hidden)
        gaussian = Gaussian(*sizes, description.slope, deviation=1.0)
    except (TypeError, ValueError) as error:
        where = str(folder / DESCRIPTION_FILE)
        raise InputError(f"is not a policy's description ({error})", where, _REMEDY) from error
    _restore(gaussian, folder / TENSOR_FILE, stored)
    return gaussian, description


def load_critic(critic: Critic, folder: Path) -> None:
    """Give a critic the numbers that a policy was trained with.

    Raises:
        InputError: when the policy has no critic, or one of another size.
    """
    document = _read(folder)
    if "critic" not in document:
        raise InputError("has no critic to go on with", str(folder / DESCRIPTION_FILE), _REMEDY)
    _restore(critic, folder / CRITIC_FILE, document["critic"])


def _restore(network: nn.Module, file: Path, stored: Mapping[str, str]) -> None:
    try:
        network.load_state_dict(read_tensors(file, stored, _REMEDY))
    except RuntimeError as error:
        raise InputError("does not hold the policy's numbers", str(file), _REMEDY) from error


def _read(folder: Path) -> dict[str, Any]:
    return read_description(folder / DESCRIPTION_FILE, SCHEMA, _SOURCE, _REMEDY)
