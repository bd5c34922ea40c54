"""Whether a hypothesis misses a part of a recording."""

import pytest

from simgap.equations.fit import fit
from simgap.equations.temper import _SHARES
from simgap.gap.hypothesis import weigh
from simgap.gap.missed import _LEAST, misses
from simgap.gap.reading import readings_of
from simgap.gap.settings import Gap
from tests.pipeline.gap.recordings import Plant, joint_recording, joint_simulator


@pytest.mark.parametrize(
    ("friction", "missed"), [(0.0, False), (0.3, True), ((0.3, 0.0, 0.0, 0.0, 0.0, 0.0), True)]
)
def test_friction_that_nobody_knows_of_is_missed_though_it_be_in_one_run(friction, missed):
    reading = readings_of(joint_recording(Plant(friction=friction)), joint_simulator(), Gap(effects=[]))[1]
    assert misses(weigh(fit(reading.nominal, reading.problem), reading)) == missed


def test_the_least_share_is_that_of_the_likelihood():
    assert _SHARES[0] == _LEAST
