"""Rotors that turn the other way than the platform file says."""

from dataclasses import replace

import pytest

from simgap.consistency import check, contradictions
from simgap.consistency.checked import Checked
from simgap.plants.concealed import record_concealed
from simgap.platforms import platform_from_config
from tests.pipeline.consistency.plants import cases


@pytest.mark.slow
@pytest.mark.parametrize("number", range(6))
def test_directions_the_other_way_round_are_told_from_another_order(number):
    case = cases("quadrotor", 9013, 6)[number]
    recording, platform = record_concealed(case)[0], platform_from_config(case.platform)
    assert check(recording, platform) == Checked()
    turned = replace(platform, rotor_directions=tuple(-each for each in platform.rotor_directions))
    (found,) = contradictions(recording, turned)
    assert (found.column, found.suspected) == ("rotor_directions", "sign")
    assert found.remedy == "Change the four signs of rotor_directions in the platform file."
