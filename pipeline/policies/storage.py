"""A policy on disk: `policy.yaml` for people, `policy.safetensors` for numbers. Loading executes nothing.

Beside it stands the critic that it was trained with, where it is to be trained further.
"""

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import yaml
from safetensors import SafetensorError
from safetensors.torch import load as tensors_from_bytes
from safetensors.torch import save as tensors_to_bytes
from torch import nn

from pipeline.artifacts import hash_path
from pipeline.errors import InputError
from pipeline.policies.networks import Critic, Gaussian

SCHEMA = "simgap.policy/1"
DESCRIPTION_FILE = "policy.yaml"
TENSOR_FILE = "policy.safetensors"
CRITIC_FILE = "critic.safetensors"
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
    document["tensors"] = _write_tensors(gaussian, folder / TENSOR_FILE)
    if critic is not None:
        document["critic"] = _write_tensors(critic, folder / CRITIC_FILE)
    text = yaml.safe_dump(document, sort_keys=False, allow_unicode=True)
    (folder / DESCRIPTION_FILE).write_text(text, encoding="utf-8")


def _write_tensors(network: nn.Module, file: Path) -> dict[str, str]:
    """Write the numbers of a network, and return what the description says of the file."""
    tensors = {name: tensor.detach().cpu().contiguous() for name, tensor in network.state_dict().items()}
    file.write_bytes(tensors_to_bytes(dict(sorted(tensors.items()))))
    return {"file": file.name, "sha256": hash_path(file)}


def load_policy(folder: Path) -> tuple[Gaussian, Description]:
    """Read a policy that `save_policy` wrote.

    Raises:
        InputError: when a file is missing, is not what it should be, or does not fit the other.
    """
    document = _read(folder / DESCRIPTION_FILE)
    document.pop("critic", None)
    try:
        expected = document.pop("tensors")["sha256"]
        description = Description(**document)
        sizes = (description.observation_size, description.action_size, description.hidden)
        gaussian = Gaussian(*sizes, description.slope, deviation=1.0)
    except (KeyError, TypeError, ValueError) as error:
        where = str(folder / DESCRIPTION_FILE)
        raise InputError(f"is not a policy's description ({error})", where, _REMEDY) from error
    _load_tensors(gaussian, folder / TENSOR_FILE, expected)
    return gaussian, description


def load_critic(critic: Critic, folder: Path) -> None:
    """Give a critic the numbers that a policy was trained with.

    Raises:
        InputError: when the policy has no critic, or one of another size.
    """
    document = _read(folder / DESCRIPTION_FILE)
    if "critic" not in document:
        raise InputError("has no critic to go on with", str(folder / DESCRIPTION_FILE), _REMEDY)
    _load_tensors(critic, folder / CRITIC_FILE, document["critic"]["sha256"])


def _load_tensors(network: nn.Module, file: Path, expected: str) -> None:
    if not file.exists() or hash_path(file) != expected:
        raise InputError("is not the file that the description belongs to", str(file), _REMEDY)
    try:
        network.load_state_dict(tensors_from_bytes(file.read_bytes()))
    except (RuntimeError, SafetensorError) as error:
        raise InputError("does not hold the policy's numbers", str(file), _REMEDY) from error


def _read(path: Path) -> dict[str, Any]:
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        remedy = "give the folder of a policy, as simgap train_policy writes it"
        raise InputError(f"cannot be read ({error.strerror})", str(path), remedy) from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError("is not plain YAML", str(path), _REMEDY) from error
    if not isinstance(document, dict) or document.pop("schema", None) != SCHEMA:
        raise InputError(f"is not of schema {SCHEMA}", str(path), _REMEDY)
    return document
