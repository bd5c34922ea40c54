"""The learned models by name."""

from collections.abc import Mapping
from typing import Any

from simgap.models.black_box import BlackBoxModel
from simgap.models.closed_form import CLOSED_FORM
from simgap.models.contract import DynamicsModel
from simgap.models.fnn import FeedForwardModel
from simgap.models.hybrid import HybridParallelModel, HybridSerialModel
from simgap.models.lstm import LongShortTermMemoryModel
from simgap.models.selection import class_from, settings_from
from simgap.models.settings import ModelSettings
from simgap.models.tcn import TemporalConvolutionModel

MODELS: dict[str, type[DynamicsModel]] = CLOSED_FORM | {
    "fnn": FeedForwardModel,
    "lstm": LongShortTermMemoryModel,
    "tcn": TemporalConvolutionModel,
    "black_box": BlackBoxModel,
    "hybrid_parallel": HybridParallelModel,
    "hybrid_serial": HybridSerialModel,
}


def model_class(values: Mapping[str, Any]) -> type[DynamicsModel]:
    """Return the class of the model that a configuration names.

    Raises:
        InputError: when there is none of that name.
    """
    return class_from(MODELS, values)


def model_settings(values: Mapping[str, Any]) -> ModelSettings:
    """Return the typed settings of the model that a configuration describes.

    Raises:
        InputError: on an unknown model or key, and on a value of the wrong type.
    """
    return settings_from(MODELS, values)
