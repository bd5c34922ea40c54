"""A model on disk: `model.yaml` for people, `model.safetensors` for numbers. Loading executes nothing."""

from pathlib import Path

from simgap.artifacts.descriptions import (
    read_description,
    read_tensors,
    write_description,
    write_tensors,
)
from simgap.errors import InputError
from simgap.models.bias_correction import BiasCorrection
from simgap.models.contract import DynamicsModel, Provenance
from simgap.models.layouts import layout_from_mapping
from simgap.models.registry import model_class, model_settings

SCHEMA = "simgap.model/1"
DESCRIPTION_FILE = "model.yaml"
TENSOR_FILE = "model.safetensors"
_REMEDY = "train the model again"


def save_model(model: DynamicsModel, folder: Path) -> None:
    """Write a model into a folder; the same model gives the same bytes."""
    folder.mkdir(parents=True, exist_ok=True)
    stored = write_tensors(model.tensors(), folder / TENSOR_FILE)
    document = {"schema": SCHEMA, **model.description(), "tensors": stored}
    write_description(document, folder / DESCRIPTION_FILE)


def load_model(folder: Path) -> DynamicsModel:
    """Read a model that `save_model` wrote.

    Raises:
        InputError: when a file is missing, is not what it should be, or does not fit the other.
    """
    path = folder / DESCRIPTION_FILE
    document = read_description(path, SCHEMA, "give a folder of a model", _REMEDY)
    try:
        settings = model_settings(document["model"])
        layout = layout_from_mapping(document["layout"])
        model = model_class(document["model"])(layout, settings, float(document["time_step"]))
        model.provenance = Provenance(**document["provenance"])
        if document.get("correction") is not None:
            model.correction = BiasCorrection.from_mapping(document["correction"], len(layout.targets))
        model.residual = bool(document.get("residual", False))
        stored = document["tensors"]
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(f"is not a model's description ({error})", str(path), _REMEDY) from error
    model.restore(read_tensors(folder / TENSOR_FILE, stored, _REMEDY))
    return model
