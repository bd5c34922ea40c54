"""Joint platforms that several tests look at."""

from pathlib import Path

import pytest
import yaml

from simgap.platforms import Joint, platform_from_config

CONF = Path(__file__).parents[4] / "conf/platform"


def joint(name: str) -> Joint:
    return platform_from_config(yaml.safe_load((CONF / f"{name}.yaml").read_text()))


@pytest.fixture(scope="session")
def servo() -> Joint:
    return joint("servo")


@pytest.fixture(scope="session")
def told() -> Joint:
    """A servo that is told a position."""
    return joint("servo_position")


@pytest.fixture(scope="session", params=["servo", "pendulum", "linear_stage", "spring_mass"])
def machine(request) -> Joint:
    return joint(request.param)
