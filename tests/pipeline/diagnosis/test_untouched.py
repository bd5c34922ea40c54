"""Channels in which much is missing that nothing named acts on."""

import pytest

from simgap.diagnosis.diagnose import diagnose, untouched
from simgap.diagnosis.locate import Mismatch
from simgap.gap.name import Naming
from simgap.gap.settings import Gap
from simgap.platforms.mechanism import Channel
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator

TORQUE, FORCE = Channel("torque", "N·m", "torque"), Channel("force_z", "m/s²", "force")


def failing(channel: Channel, share: float) -> Mismatch:
    return Mismatch(channel, share, 50.0, ("speed", 0.0, 1.0), {"run": 1.0}, 0.0, "It fails.")


@pytest.fixture(scope="module")
def naming() -> Naming:
    """Name the friction of a joint."""
    recording = joint_recording(Plant(friction=0.3))
    return diagnose(recording, joint_simulator(), Gap(effects=["coulomb_friction"])).naming


@pytest.mark.slow
def test_a_channel_that_no_name_and_no_formula_acts_on_is_said(naming):
    found = [failing(TORQUE, 0.6), failing(FORCE, 0.4)]
    (said,) = untouched(naming, found, [TORQUE])
    assert said.startswith("nothing that is named acts on force_z (40% of the error): ")
    assert untouched(naming, found, [TORQUE, FORCE]) == []


@pytest.mark.slow
def test_a_small_share_is_not_said(naming):
    assert untouched(naming, [failing(TORQUE, 0.95), failing(FORCE, 0.05)], [TORQUE]) == []
