"""Floor 0: names of a package that are imported when they are first asked for."""

from collections.abc import Callable, Sequence
from importlib import import_module
from typing import Any


def imported_late(package: str, **names: Sequence[str]) -> Callable[[str], Any]:
    """Return the `__getattr__` of a package whose modules are not imported with it.

    No name may be that of a module of the package: after `import package.name` it would stand for the module.

    Args:
        package: its `__name__`.
        names: what the package offers, by the module that defines it.
    """
    module_of = {name: module for module, members in names.items() for name in members}

    def get(name: str) -> Any:
        if name not in module_of:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(f"{package}.{module_of[name]}"), name)

    return get
