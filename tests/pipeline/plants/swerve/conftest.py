"""Swerve platforms that several tests look at."""

from pathlib import Path

import pytest
import yaml

from simgap.platforms import Swerve, platform_from_config

CONF = Path(__file__).parents[4] / "conf/platform"


@pytest.fixture(scope="session", params=["swerve_robot", "swerve_trolley"])
def machine(request) -> Swerve:
    return platform_from_config(yaml.safe_load((CONF / f"{request.param}.yaml").read_text()))


@pytest.fixture(scope="session")
def robot() -> Swerve:
    return platform_from_config(yaml.safe_load((CONF / "swerve_robot.yaml").read_text()))
