"""Shared fixtures: shape and type checks on, and the real recordings where they are at hand."""

import os
from pathlib import Path

import pytest
from hypothesis import settings
from jaxtyping import install_import_hook

import pipeline.physics.cable_steps  # noqa: F401  # what is compiled takes no checks, so it comes before them

install_import_hook("pipeline", "beartype.beartype")
settings.register_profile("untimed", deadline=None)  # the first example pays for imports
settings.load_profile("untimed")


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Return the folder of real recordings (`SIMGAP_DATA`, else `../shared/data` beside the checkout)."""
    beside = Path(__file__).parents[2] / "shared" / "data"
    folder = Path(os.environ.get("SIMGAP_DATA", beside))
    if not folder.is_dir():
        pytest.skip("the real recordings are not here: set SIMGAP_DATA to their folder")
    return folder
