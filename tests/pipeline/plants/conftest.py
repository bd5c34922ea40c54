"""A platform, and short flights of it that several tests look at."""

from pathlib import Path

import pytest
import yaml

from simgap.platforms import Quadrotor, platform_from_config

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="session")
def racer() -> Quadrotor:
    return platform_from_config(yaml.safe_load((ROOT / "conf/platform/racer.yaml").read_text()))
