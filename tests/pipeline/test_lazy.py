"""Packages whose modules are imported late."""

import pkgutil
from types import ModuleType

import pytest

from simgap import recordings
from simgap.lazy import imported_late
from simgap.recordings import cleaning


@pytest.mark.parametrize("package", [recordings, cleaning])
def test_every_name_is_there_and_is_not_that_of_a_module(package: ModuleType) -> None:
    modules = {module.name for module in pkgutil.iter_modules(package.__path__)}
    assert not modules & set(package.__all__)
    for name in package.__all__:
        assert getattr(package, name) is not None


def test_a_name_comes_from_its_module() -> None:
    from json.decoder import JSONDecoder

    assert imported_late("json", decoder=("JSONDecoder",))("JSONDecoder") is JSONDecoder


def test_an_unknown_name_is_an_attribute_that_is_not_there() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'nonsense'"):
        cleaning.nonsense  # noqa: B018
