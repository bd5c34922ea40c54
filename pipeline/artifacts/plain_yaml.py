"""Plain YAML of a person: numbers as YAML 1.2 writes them, bounded, and without anything that is executed."""

import re
from functools import cache
from pathlib import Path
from typing import Any

from simgap.artifacts.bounded import whole_of
from simgap.errors import InputError

_LARGEST = 1  # MB; a platform or a mapping takes a few kB
_MOST_VALUES = 100_000  # with every alias written out

# YAML 1.1, which PyYAML reads, takes 5e-05 and 1.5e5 for text: it wants a point and a sign. YAML 1.2 (section
# 10.2.1.4) and OmegaConf take them for numbers.
_NUMBER = re.compile(r"[-+]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)[eE][-+]?[0-9]+$")


def read_yaml(path: Path) -> Any:
    """Return what a YAML file holds; `5e-05` is a number.

    Raises:
        InputError: when the file cannot be read, is no plain YAML or is too large.
    """
    return _parsed(whole_of(path, _LARGEST, "give the file that describes, not a log"), str(path))


def _parsed(content: bytes, where: str) -> Any:
    import yaml

    try:
        values = yaml.load(content.decode("utf-8"), Loader=_loader())
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputError("is not plain YAML", where, "correct the file") from error
    _check_size(values, where)
    return values


def _check_size(values: Any, where: str) -> None:
    """Refuse few lines of aliases that stand for very many values, or for themselves."""
    waiting, seen = [values], 0
    while waiting:
        value = waiting.pop()
        seen += 1
        if isinstance(value, dict):
            waiting += value.values()
        elif isinstance(value, list | tuple | set):
            waiting += value
        if seen + len(waiting) > _MOST_VALUES:
            raise InputError(f"holds more than {_MOST_VALUES} values", where, "write fewer aliases")


@cache
def _loader() -> Any:
    import yaml

    class Loader(yaml.SafeLoader):
        """The safe loader with the numbers of YAML 1.2."""

    Loader.add_implicit_resolver("tag:yaml.org,2002:float", _NUMBER, list("-+.0123456789"))
    return Loader
