"""Shared fixtures: shape and type checks on, and the real recordings where they are at hand."""

import importlib
import os
from pathlib import Path

import pytest
from hypothesis import settings
from jaxtyping import install_import_hook

STAGES = Path(__file__).with_name("stages")

settings.register_profile("untimed", deadline=None)  # the first example pays for imports
settings.load_profile("untimed")


def pytest_configure(config: pytest.Config) -> None:
    """Check shapes and types at every call, but where slow tests run alone: those would take twice as long."""
    if config.getoption("markexpr") != "slow":
        # What is compiled takes no checks, so it is imported before they are on.
        compiled = (
            "equations.mixture_steps",
            "physics.cable_steps",
            "physics.swing_search",
            "physics.hysteresis_steps",
            "physics.lag_steps",
            "physics.play_steps",
            "physics.rotation_steps",
            "logs.readers.blackbox_frames",
        )
        for module in compiled:
            importlib.import_module(f"simgap.{module}")
        install_import_hook("simgap", "beartype.beartype")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Count tests of whole stages as slow, and begin with those of minutes, which would run alone at the end."""
    for item in items:
        if STAGES in item.path.parents and item.get_closest_marker("slow") is None:
            item.add_marker(pytest.mark.slow)
    items.sort(key=_minutes, reverse=True)


def _minutes(item: pytest.Item) -> float:
    marker = item.get_closest_marker("slow")
    return marker.kwargs.get("minutes", 0.0) if marker else 0.0


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Return the folder of real recordings (`SIMGAP_DATA`, else `../shared/data` beside the checkout)."""
    beside = Path(__file__).parents[2] / "shared" / "data"
    folder = Path(os.environ.get("SIMGAP_DATA", beside))
    if not folder.is_dir():
        pytest.skip("the real recordings are not here: set SIMGAP_DATA to their folder")
    return folder
