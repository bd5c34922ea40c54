"""The learned models by name."""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

from simgap.errors import InputError
from simgap.models.black_box import BlackBoxModel
from simgap.models.contract import DynamicsModel
from simgap.models.fnn import FeedForwardModel
from simgap.models.hybrid import HybridParallelModel, HybridSerialModel
from simgap.models.linear import LinearModel
from simgap.models.lstm import LongShortTermMemoryModel
from simgap.models.narx import NarxModel
from simgap.models.rbf import RadialBasisModel
from simgap.models.settings import ModelSettings
from simgap.models.state_space import StateSpaceModel
from simgap.models.tcn import TemporalConvolutionModel
from simgap.models.transfer_function import TransferFunctionModel
from simgap.models.white_box import WhiteBoxModel
from simgap.runner.mistakes import configuration_mistakes

MODELS: dict[str, type[DynamicsModel]] = {
    "linear": LinearModel,
    "state_space": StateSpaceModel,
    "fnn": FeedForwardModel,
    "lstm": LongShortTermMemoryModel,
    "tcn": TemporalConvolutionModel,
    "white_box": WhiteBoxModel,
    "black_box": BlackBoxModel,
    "hybrid_parallel": HybridParallelModel,
    "hybrid_serial": HybridSerialModel,
    "transfer_function": TransferFunctionModel,
    "narx": NarxModel,
    "rbf": RadialBasisModel,
}


def model_class(values: Mapping[str, Any], where: str = "model") -> type[DynamicsModel]:
    """Return the class of the model that a configuration names.

    Raises:
        InputError: when there is none of that name.
    """
    name = values.get("name")
    if not isinstance(name, str) or name not in MODELS:
        near = get_close_matches(str(name), MODELS, n=1)
        remedy = f"did you mean {near[0]!r}?" if near else f"use one of {', '.join(MODELS)}"
        raise InputError(f"there is no model {name!r}", f"{where}.name", remedy)
    return MODELS[name]


def model_settings(values: Mapping[str, Any]) -> ModelSettings:
    """Return the typed settings of the model that a configuration describes.

    Raises:
        InputError: on an unknown model or key, and on a value of the wrong type.
    """
    from omegaconf import OmegaConf

    schema = model_class(values).settings_class
    with configuration_mistakes():
        merged = OmegaConf.merge({"model": OmegaConf.structured(schema)}, {"model": dict(values)})
        settings = OmegaConf.to_object(merged.model)
    assert isinstance(settings, schema)
    return settings
