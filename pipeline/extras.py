"""Floor 0: libraries that only some commands need, and the extra of the package that brings each."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec

from simgap.errors import InputError

# Module to distribution, where the two are called differently.
_OTHER_NAMES = {"cv2": "opencv-python-headless", "sklearn": "scikit-learn"}
_OPTIONAL = re.compile(r'([\w.-]+)[^;\[]*;.*\bextra == "([\w-]+)"')


@contextmanager
def named_extras() -> Iterator[None]:
    """Turn the import of a library that only an extra brings into one line with the command that installs it.

    Raises:
        InputError: when such a library is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        missing = _missing(_distribution(error.name or ""))
        if missing is None:
            raise
        raise missing from error


def require(module: str) -> None:
    """Refuse to go on without a library, before any work is done.

    Raises:
        InputError: when it is not installed.
    """
    with named_extras():
        if find_spec(module) is None:
            raise ModuleNotFoundError(name=module)


def missing_launcher(option: str) -> InputError | None:
    """Return what to say of a launcher of Hydra that is not there; None where no extra brings it."""
    return _missing(f"hydra-{option.partition('_')[0]}-launcher")


def _missing(distribution: str) -> InputError | None:
    extra = _extra_of(distribution)
    return InputError(f"needs {distribution}", remedy=f"pip install 'simgap[{extra}]'") if extra else None


def _extra_of(distribution: str) -> str | None:
    """Return the first extra in the package's own metadata that asks for a distribution."""
    # Imported here, since that takes as long as all of `simgap --help`.
    from importlib.metadata import PackageNotFoundError, requires

    try:
        optional = filter(None, map(_OPTIONAL.match, requires("simgap") or []))
    except PackageNotFoundError:
        return None
    return next((entry[2] for entry in optional if entry[1] == distribution), None)


def _distribution(module: str) -> str:
    name = module.partition(".")[0]
    return _OTHER_NAMES.get(name, name.replace("_", "-"))
