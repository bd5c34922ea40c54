"""The class and the typed settings of the model that a configuration names, out of a table of models."""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

from simgap.errors import InputError
from simgap.models.contract import DynamicsModel
from simgap.models.settings import ModelSettings
from simgap.runner.mistakes import configuration_mistakes

Models = Mapping[str, type[DynamicsModel]]


def class_from(
    models: Models, values: Mapping[str, Any], what: str = "model", where: str = "model"
) -> type[DynamicsModel]:
    """Return the class of the model that a configuration names.

    Args:
        models: to choose from, by name.
        values: the configuration.
        what: it configures, for messages.
        where: it stands.

    Raises:
        InputError: when there is none of that name.
    """
    name = values.get("name")
    if not isinstance(name, str) or name not in models:
        near = get_close_matches(str(name), models, n=1)
        remedy = f"did you mean {near[0]!r}?" if near else f"use one of {', '.join(models)}"
        raise InputError(f"there is no {what} {name!r}", f"{where}.name", remedy)
    return models[name]


def settings_from(models: Models, values: Mapping[str, Any]) -> ModelSettings:
    """Return the typed settings of the model that a configuration describes.

    Raises:
        InputError: on an unknown model or key, and on a value of the wrong type.
    """
    from omegaconf import OmegaConf

    schema = class_from(models, values).settings_class
    with configuration_mistakes():
        merged = OmegaConf.merge({"model": OmegaConf.structured(schema)}, {"model": dict(values)})
        settings = OmegaConf.to_object(merged.model)
    assert isinstance(settings, schema)
    return settings
