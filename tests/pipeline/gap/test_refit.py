"""One effect more, from wherever its fit has to begin."""

from dataclasses import replace

import pytest

from simgap.effects import effect_by_key
from simgap.gap.fit import fit
from simgap.gap.reading import readings_of
from simgap.gap.refit import extend
from simgap.gap.settings import Gap
from simgap.simulation import Simulator
from tests.pipeline.gap.problems import FEW, quick
from tests.pipeline.gap.recordings import Plant, flight, joint_recording, joint_simulator, late, racer

LIMIT = 4.0
"""A: the smaller it is, the less do commands do, and the larger is the noise on their side."""


def test_an_offset_of_clocks_is_found_where_they_deviate_from_run_to_run():
    """An offset of 0 is no simulator without one: the runs' deviations act beside it."""
    recording = late(flight(), samples=1)
    offset = recording.time_step
    deviations = {run: 3e-3 * (-1) ** place for place, run in enumerate(recording.runs)}
    told = replace(recording, clock_offset={run: offset + more for run, more in deviations.items()})
    reading = readings_of(told, Simulator(racer()), Gap())[0]
    effect = effect_by_key("quadrotor", "sensor_time_offset")
    extended = extend(fit(reading.nominal, reading.problem), effect, reading.problem, reading.starts)
    polished = fit(extended.simulator, reading.problem)
    values = [each.simulator.free[0].values["offset"] for each in (extended, polished)]
    assert values[0] == pytest.approx(values[1], rel=0.1)  # a few steps
    assert abs(values[0]) == pytest.approx(offset, rel=0.25)


def test_a_limit_is_found_beside_a_wrong_constant():
    """Beside the nominal constant the limit looks like another one, and where it is not reached it has no slope."""
    recording = joint_recording(Plant(motor_constant=0.88, current_limit=LIMIT))
    found = quick(recording, joint_simulator(), FEW)
    values = {f.effect.key: f.values for f in found.simulator.effects}
    assert values["current_limit"]["limit"] == pytest.approx(LIMIT, rel=0.03)
    assert values["motor_constant_error"]["ratio"] == pytest.approx(0.88, rel=0.02)
