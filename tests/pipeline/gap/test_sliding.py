"""Wheels that slide and motors that are limited both pull no harder than so much: recorded from the concealed plant."""

import pytest

from simgap.diagnosis.diagnose import diagnose
from simgap.gap.settings import Gap
from simgap.plants import case_from_config, record_case
from simgap.platforms import platform_from_config
from simgap.recordings.cleaning import clean_with_coverage
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.split import Split
from simgap.runner.compose import compose
from simgap.simulation import Simulator

pytestmark = pytest.mark.slow

CONCEALED = {
    "wheel_slip@drive": {"friction_coefficient": 0.2, "stiffness": 40.0, "height": 0.05},
    "current_limit@drive": {"limit": 12.0},
}

ALIKE = [*CONCEALED, "motor_constant_error@drive", "mass_error@drive", "command_delay@drive"]


@pytest.mark.parametrize("key", CONCEALED)
def test_the_one_is_told_from_the_other(key):
    platform = platform_from_config(compose(["platform=swerve_robot"])["platform"])
    concealed = {"effects": {key: CONCEALED[key]}, "runs": 6, "duration": 8.0, "rate": 50.0}
    recording, _ = record_case(case_from_config("swerve", concealed), platform, seed=4)
    cleaned = clean_with_coverage(recording, Cleaning(), Split(holdout=["weave_*"]), 0).recording
    named = diagnose(cleaned, Simulator(platform), Gap(effects=ALIKE)).naming.named
    assert [candidate.effect.key for candidate in named][:1] == [key]
