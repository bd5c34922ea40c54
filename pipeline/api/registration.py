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
    """Leaves it to the others to find Gymnasium, and has the environments registered once it is loaded."""

    def __init__(self) -> None:
        self._asking = False

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return how Gymnasium is loaded and registered with; None for every other module."""
        if fullname != _GYMNASIUM or self._asking:
            return None
        self._asking = True
        try:
            spec = find_spec(fullname)
        finally:
            self._asking = False
        if spec is not None and spec.loader is not None:
            spec.loader = _Registering(spec.loader, self)
        return spec


class _Registering(Loader):
    """A loader that registers the environments once the module's own loader has loaded it."""

    def __init__(self, loader: Loader, waiting: _Waiting) -> None:
        self._loader, self._waiting = loader, waiting

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Return what the module's own loader makes."""
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Load the module with its own loader, which it keeps, and register."""
        module.__loader__ = self._loader
        if module.__spec__ is not None:
            module.__spec__.loader = self._loader
        self._loader.exec_module(module)
        sys.meta_path.remove(self._waiting)
        _register(module)
