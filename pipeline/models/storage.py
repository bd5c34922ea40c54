"""A model on disk: `model.yaml` for people, `model.safetensors` for numbers. Loading executes nothing."""

from pathlib import Path
from typing import Any

import yaml
from safetensors import SafetensorError
from safetensors.torch import load as tensors_from_bytes
from safetensors.torch import save as tensors_to_bytes

from pipeline.artifacts import hash_path
from pipeline.errors import InputError
from pipeline.models.bias_correction import BiasCorrection
from pipeline.models.contract import DynamicsModel, Provenance
from pipeline.models.layout import layout_from_mapping
from pipeline.models.registry import model_class, model_settings

SCHEMA = "simgap.model/1"
DESCRIPTION_FILE = "model.yaml"
TENSOR_FILE = "model.safetensors"


def save_model(model: DynamicsModel, folder: Path) -> None:
    """Write a model into a folder; the same model gives the same bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    tensors = {name: tensor.detach().contiguous() for name, tensor in sorted(model.tensors().items())}
    (folder / TENSOR_FILE).write_bytes(tensors_to_bytes(tensors))
    document = {
        "schema": SCHEMA,
        **model.description(),
        "tensors": {"file": TENSOR_FILE, "sha256": hash_path(folder / TENSOR_FILE)},
    }
    text = yaml.safe_dump(document, sort_keys=False, allow_unicode=True)
    (folder / DESCRIPTION_FILE).write_text(text, encoding="utf-8")


def load_model(folder: Path) -> DynamicsModel:
    """Read a model that `save_model` wrote.

    Raises:
        InputError: when a file is missing, is not what it should be, or does not fit the other.
    """
    path = folder / DESCRIPTION_FILE
    document = _read_description(path)
    try:
        settings = model_settings(document["model"])
        layout = layout_from_mapping(document["layout"])
        model = model_class(document["model"])(layout, settings, float(document["time_step"]))
        model.provenance = Provenance(**document["provenance"])
        if document.get("correction") is not None:
            model.correction = BiasCorrection.from_mapping(document["correction"], len(layout.targets))
        expected = document["tensors"]["sha256"]
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(
            f"is not a model's description ({error})", str(path), "train the model again"
        ) from error
    tensors = folder / TENSOR_FILE
    if hash_path(tensors) != expected:
        raise InputError(
            "is not the file that the description belongs to", str(tensors), "train the model again"
        )
    try:
        model.restore(tensors_from_bytes(tensors.read_bytes()))
    except SafetensorError as error:
        raise InputError("is not a safetensors file", str(tensors), "train the model again") from error
    return model


def _read_description(path: Path) -> dict[str, Any]:
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(
            f"cannot be read ({error.strerror})", str(path), "give a folder of a model"
        ) from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError("is not plain YAML", str(path), "train the model again") from error
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise InputError(f"is not of schema {SCHEMA}", str(path), "train the model again")
    return document
