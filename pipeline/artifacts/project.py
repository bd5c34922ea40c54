"""Where the package and its configuration lie, in a checkout and in an installation."""

from pathlib import Path

from simgap.errors import InputError

PACKAGE = Path(__file__).resolve().parents[1]
"""The folder of the package `simgap`; in a checkout it is called `pipeline`."""

CHECKOUT = PACKAGE.parent if (PACKAGE.parent / "dvc.yaml").is_file() and PACKAGE.name == "pipeline" else None
"""The repository that the package is part of; None for an installed one."""

PROJECT_ROOT = CHECKOUT or Path.cwd()
"""Where what a person keeps lies: the checkout, else the folder in which the command was called."""

CONFIGURATION = (CHECKOUT or PACKAGE) / "conf"
STAGES = (CHECKOUT or PACKAGE) / "stages"


def require_checkout(what: str = "it") -> Path:
    """Return the checkout, for what changes the repository itself.

    Args:
        what: a person asked for.

    Raises:
        InputError: in an installation.
    """
    if CHECKOUT is None:
        raise InputError(
            f"{what} works in a clone of the repository only, with the command that `make install` puts there",
            remedy="clone it, run make install in it, and call .venv/bin/simgap there",
        )
    return CHECKOUT
