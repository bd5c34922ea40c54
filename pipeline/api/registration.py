"""Makes Gymnasium know the environments of this package, whichever of the two is imported first.

Gymnasium 1 has no plugins: an environment is known once something has registered it. Gymnasium imports NumPy, which
takes longer than this package may take, so this package waits until somebody imports Gymnasium.
"""

import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType

_GYMNASIUM = "gymnasium"
_ID, _ENTRY = "simgap/Race-v0", "simgap.api.race:race"


def register_environments() -> None:
    """Register the environments now if Gymnasium is imported already, else as soon as it is."""
    if _GYMNASIUM in sys.modules:
        _register(sys.modules[_GYMNASIUM])
    elif not any(isinstance(finder, _Waiting) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Waiting())


def _register(gymnasium: ModuleType) -> None:
    # Without its submodules it is being imported at the moment, by somebody who imports this package on the way.
    if hasattr(gymnasium, "register") and _ID not in gymnasium.registry:
        gymnasium.register(id=_ID, entry_point=_ENTRY)


class _Waiting(MetaPathFinder):
    """Finds nothing; once Gymnasium is looked for, it has it loaded as ever and registers the environments after."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return how Gymnasium is loaded and registered with; None for every other module."""
        if fullname != _GYMNASIUM:
            return None
        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec is not None and spec.loader is not None:
            spec.loader = _Registering(spec.loader)
        return spec


class _Registering(Loader):
    """A loader that registers the environments once the module is loaded."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Return what the module's own loader makes."""
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Load the module and register."""
        self._loader.exec_module(module)
        _register(module)
