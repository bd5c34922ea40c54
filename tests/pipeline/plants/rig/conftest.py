"""The configured rig."""

from pathlib import Path

import pytest
import yaml

from simgap.plants import case_from_config
from simgap.plants.rig.case import RigCase

ROOT = Path(__file__).parents[4]


@pytest.fixture(scope="session")
def configured() -> RigCase:
    return case_from_config("quadrotor", yaml.safe_load((ROOT / "conf/record/attitude_rig.yaml").read_text()))
