"""One effect more, from wherever its fit has to begin."""

from dataclasses import replace

import numpy as np
import pytest

from simgap.effects import effect_by_key
from simgap.equations.fit import fit
from simgap.equations.refit import extend
from simgap.gap.reading import readings_of
from simgap.gap.settings import Gap
from simgap.simulation import Simulator
from tests.pipeline.gap.problems import FEW, quick
from tests.pipeline.gap.recordings import (
    TIME_STEP,
    Plant,
    flight,
    joint_recording,
    joint_simulator,
    late,
    motion,
    racer,
    recording_of,
)

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


@pytest.mark.slow
def test_a_limit_is_found_beside_a_wrong_constant():
    """Beside the nominal constant the limit looks like another one, and where it is not reached it has no slope."""
    recording = joint_recording(Plant(motor_constant=0.88, current_limit=LIMIT))
    found = quick(recording, joint_simulator(), FEW)
    values = {f.effect.key: f.values for f in found.simulator.effects}
    assert values["current_limit"]["limit"] == pytest.approx(LIMIT, rel=0.03)
    assert values["motor_constant_error"]["ratio"] == pytest.approx(0.88, rel=0.02)


@pytest.mark.parametrize("moving", [0.15, 0.4])
@pytest.mark.parametrize("seed", range(3))
def test_friction_is_found_though_the_joint_rests_most_of_the_time(moving, seed):
    """Rows at rest are met without friction, and weigh far more than those in motion."""
    random, time = np.random.default_rng(seed), np.arange(1600) * TIME_STEP
    waves = [
        random.uniform(3.0, 8.0) * np.sin(2.0 * np.pi * random.uniform(0.5, 2.0) * time) for _ in range(6)
    ]
    voltage = np.stack(waves) * (time < moving * time[-1])
    position, velocity = motion(Plant(friction=0.3), voltage)
    noise = random.standard_normal((2, *position.shape))
    recording = recording_of(voltage, position + 2e-4 * noise[0], velocity + 0.02 * noise[1])
    held = readings_of(recording, joint_simulator(), Gap())[1]
    effect = effect_by_key("joint", "coulomb_friction")
    found = extend(fit(held.nominal, held.problem), effect, held.problem, held.starts)
    assert found.simulator.free[0].values["level"] == pytest.approx(0.3, rel=0.03)
