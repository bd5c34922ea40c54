"""The width of windows: as wide as the motion is slow."""

import numpy as np
import pandas as pd
import pytest

from simgap.equations.width import width_of
from simgap.gap.reading import readings_of
from simgap.gap.settings import Gap
from simgap.platforms import Joint
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.blocks import cut_blocks

INERTIA = 0.01
RATE = 1000.0
WIDEST = Gap().test_width


def spring(frequency: float) -> Joint:
    """Return an axis that swings on a spring at a frequency in Hz."""
    return Joint(inertia=INERTIA, stiffness=INERTIA * (2.0 * np.pi * frequency) ** 2)


def swinging(frequency: float, noise: float = 0.0, seconds: float = 8.0) -> Recording:
    """Return an axis on a spring, driven by a sum of sines about its resonance in Hz: the exact solution."""
    random = np.random.default_rng(1)
    t = np.arange(0.0, seconds, 1.0 / RATE)
    position, velocity, effort = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    stiffness = spring(frequency).stiffness
    for ratio in (0.6, 0.8, 1.1, 1.3):
        rate, phase = 2.0 * np.pi * ratio * frequency, random.uniform(0.0, 2.0 * np.pi)
        position += np.sin(rate * t + phase)
        velocity += rate * np.cos(rate * t + phase)
        effort += (stiffness - INERTIA * rate**2) * np.sin(rate * t + phase)
    velocity += noise * velocity.std() * random.standard_normal(len(t))
    frame = pd.DataFrame(
        {"run": "a", "t": t, "segment": 0, "filled": 0, "position": position, "velocity": velocity}
    ).assign(effort=effort)
    units = {"position": "rad", "velocity": "rad/s", "effort": "N·m"}
    return Recording(frame, "joint", units, cleaned=True)


def chosen(frequency: float, noise: float = 0.0) -> float:
    recording, platform = swinging(frequency, noise), spring(frequency)
    blocks = cut_blocks(recording, platform, 1.0, 0.5, held=False)
    return width_of(Simulator(platform), blocks, WIDEST)


@pytest.mark.parametrize("noise", [0.0, 0.05])
def test_slow_motion_keeps_the_widest_windows(noise):
    assert chosen(1.0, noise) == WIDEST


@pytest.mark.parametrize("frequency", [20.0, 40.0, 80.0])
def test_windows_are_no_wider_than_a_period_of_fast_motion(frequency):
    assert 0.2 / frequency < chosen(frequency) <= 1.0 / frequency


def test_motion_that_is_twice_as_fast_gets_windows_half_as_wide():
    assert chosen(40.0) == pytest.approx(chosen(20.0) / 2.0)


def test_both_readings_of_a_recording_have_the_same_windows():
    recording = swinging(40.0)
    measured, held = readings_of(recording, Simulator(spring(40.0)), Gap())
    assert measured.prepared.width == held.prepared.width
    assert measured.problem.counted is held.problem.counted


def test_fast_motion_that_a_law_explains_is_not_taken_for_noise():
    """At a tenth of the sampling rate a fifth difference shows the motion itself."""
    recording = swinging(100.0)
    without_spring = Simulator(Joint(inertia=INERTIA))
    reading, _ = readings_of(recording, without_spring, Gap())
    left = reading.problem.residual(without_spring).square().mean().sqrt()
    assert float(reading.problem.noise) < 0.02 * float(left)
