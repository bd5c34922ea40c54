"""How probable rows are: more where more is explained, and not where everything is made small."""

import functools
from dataclasses import replace

import numpy as np
import pytest
import torch

from simgap.effects import effect_by_key
from simgap.equations.fit import Fit, clustered_covariance, fit, jacobian_of
from simgap.equations.problem import Problem
from simgap.equations.residuals import channels_on
from simgap.equations.row_noise import TOLERATED
from simgap.gap.likelihood import LikelihoodOf
from simgap.gap.reading import Reading, readings_of
from simgap.gap.settings import Gap
from simgap.platforms import Joint
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import (
    TIME_STEP,
    Plant,
    flight,
    joint_recordings,
    joint_simulator,
    racer,
    recording_of,
)
from tests.pipeline.gap.units import driven_by_effort, in_units


def fitted_as(simulator: Simulator, problem: Problem) -> Fit:
    """Return a simulator as if its values had been fitted."""
    residual = problem.residual(simulator)
    jacobian, scale = jacobian_of(simulator, problem, residual), problem.weigh(residual, simulator)[0]
    return Fit(
        simulator, residual, jacobian, scale, clustered_covariance(jacobian, residual, scale, problem.cluster)
    )


def with_effects(simulator: Simulator, **values: dict[str, float]) -> Simulator:
    effects = [FittedEffect(effect_by_key("joint", name), known) for name, known in values.items()]
    return simulator.with_effects((*simulator.effects, *effects))


@functools.cache
def short(plant: Plant) -> Recording:
    return joint_recordings(plant, [0], runs=3, duration=4.0)[0]


@functools.cache
def read(plant: Plant, held: bool = True) -> Reading:
    return readings_of(short(plant), joint_simulator(), Gap())[int(held)]


DRAG = 0.3  # N·m·s/rad


def shaken(runs: int = 4, samples: int = 1600) -> tuple[Recording, Simulator]:
    """An axis that slowly follows an effort against drag, while something shakes it at 3 Hz."""
    random, time = np.random.default_rng(0), np.arange(samples) * TIME_STEP
    phase = random.uniform(0.0, 2.0 * np.pi, (2, runs, 1))
    effort = 3.0 * np.sin(2.0 * np.pi * 0.2 * time + phase[0])
    velocity = effort / DRAG + 0.3 * np.sin(2.0 * np.pi * 3.0 * time + phase[1])
    read = velocity + 1e-3 * random.standard_normal(velocity.shape)
    recording = recording_of(effort, np.cumsum(velocity, axis=1) * TIME_STEP, read)
    frame = recording.frame.rename(columns={"voltage": "effort"})
    return replace(recording, frame=frame), Simulator(Joint(inertia=0.5))


def test_the_truth_is_more_probable_than_values_next_to_it():
    reading = read(Plant(friction=0.3))
    values = {
        level: reading.likelihood_of(
            fitted_as(with_effects(reading.nominal, coulomb_friction={"level": level}), reading.problem)
        ).value
        for level in (0.0, 0.15, 0.25, 0.3, 0.35, 0.6)
    }
    assert max(values, key=values.__getitem__) == 0.3
    assert values[0.0] < values[0.15] < values[0.25] > -np.inf
    assert values[0.35] > values[0.6]


@pytest.mark.parametrize("inertia", [1 / 3, 1.0, 3.0])
@pytest.mark.parametrize(
    "silencer",
    [{"dead_zone": {"width": 1e4}}, {"current_limit": {"limit": 1e-3}}],
    ids=["dead_zone", "current_limit"],
)
@pytest.mark.parametrize(
    "plant",
    [Plant(friction=0.3), Plant(other=lambda q, v: 2.0 * np.sin(3.0 * q)), Plant(motor_constant=0.5)],
    ids=["friction", "unknown", "motor"],
)
def test_equations_that_are_met_by_making_everything_zero_do_not_win(plant, silencer, inertia):
    """A drive that passes no command on beside an inertia that nothing has to move: no force is missing there."""
    reading = read(plant)
    silent = with_effects(reading.nominal, **silencer, inertia_error={"ratio": inertia})
    nothing, nominal = (
        reading.likelihood_of(fitted_as(each, reading.problem)).value for each in (silent, reading.nominal)
    )
    assert nothing < nominal


def test_an_effort_that_is_scaled_away_does_not_win():
    recording, simulator = driven_by_effort(short(Plant(friction=0.3)))
    reading = readings_of(recording, simulator, Gap())[0]
    zeroed = with_effects(reading.nominal, dead_zone={"width": 1e4}, inertia_error={"ratio": 1 / 3})
    nothing, nominal = (
        reading.likelihood_of(fitted_as(each, reading.problem)).value for each in (zeroed, reading.nominal)
    )
    assert nothing < nominal


@pytest.mark.parametrize(("effort", "travel"), [(1e3, 1.0), (1.0, 57.3)])
def test_what_one_simulator_has_over_another_does_not_depend_on_units(effort, travel):
    plain = driven_by_effort(short(Plant(friction=0.3)))
    gains = []
    for (recording, simulator), size in (
        (plain, 1.0),
        (in_units(*plain, effort=effort, travel=travel), effort),
    ):
        reading = readings_of(recording, simulator, Gap())[0]
        friction = with_effects(reading.nominal, coulomb_friction={"level": 0.3 * size})
        values = [
            reading.likelihood_of(fitted_as(each, reading.problem)).value
            for each in (friction, reading.nominal)
        ]
        gains.append(values[0] - values[1])
    assert gains[1] == pytest.approx(gains[0], abs=0.01)


def test_residuals_are_measured_against_what_commands_do():
    reading = read(Plant(friction=0.3))
    gain = reading.problem.gain
    silent = with_effects(reading.nominal, dead_zone={"width": 1e4})
    friction = with_effects(reading.nominal, viscous_friction={"coefficient": 0.3})
    halved = with_effects(reading.nominal, motor_constant_error={"ratio": 0.5})
    assert gain.factor(reading.nominal) == 1.0
    assert gain.factor(friction) == pytest.approx(1.0, rel=1e-6)
    assert gain.factor(halved) == pytest.approx(2.0, rel=1e-6)
    stronger = with_effects(reading.nominal, motor_constant_error={"ratio": 1.25})
    assert gain.factor(stronger) == pytest.approx(0.8, rel=1e-6)  # though back-EMF leaves it less current
    assert gain.factor(silent) > 1e3


def test_a_gear_that_keeps_most_of_the_effort_leaves_little_of_a_command():
    """Without a voltage the motor brakes, and friction that grows with this load would pass for a great command."""
    reading = read(Plant(friction=0.3))
    rubbed = with_effects(reading.nominal, load_dependent_friction={"ratio": 0.9})
    assert float(reading.problem.gain.factor(rubbed)) > 1.5


@pytest.mark.parametrize(
    "timing", [{"command_delay": {"delay": 0.1}}, {"sensor_time_offset": {"offset": 0.1}}]
)
def test_a_voltage_in_time_with_the_motion_is_no_weak_one(timing):
    """A late motor answers as strongly. Beside back-EMF in time with it, its voltage leaves less current."""
    reading = read(Plant(delay=0.1))
    late = with_effects(reading.nominal, **timing)
    assert float(reading.problem.gain.factor(late)) == pytest.approx(1.0, rel=0.05)


def test_a_limit_that_takes_most_of_a_motor_raises_the_noise_with_the_rows():
    """On the side of the commands rows grow as they do less, and the noise of the motion grows with them."""
    plant = Plant(current_limit=0.8)
    reading = read(plant)
    likelihood = LikelihoodOf(reading.problem, reading.nominal)
    limited = with_effects(reading.nominal, current_limit={"limit": plant.current_limit})
    assert float(reading.problem.factor(limited)) > 3.0
    fits = [fitted_as(each, reading.problem) for each in (limited, reading.nominal)]
    noise = likelihood.noise(fits[0])[0] / likelihood.noise(fits[1])[0]
    assert float(noise.sqrt()) == pytest.approx(float(reading.problem.loudness(limited)), rel=0.3)


def test_rows_hold_no_more_noise_than_is_left_of_them():
    """A law that makes what it predicts jump looks noisy, and would meet blocks by less than the noise for nothing."""
    reading = read(Plant())
    likelihood = LikelihoodOf(reading.problem, reading.nominal)
    found = fitted_as(reading.nominal, reading.problem)
    quadrature = reading.problem.quadrature.square()
    for share in (0.1, 10.0):
        residual = share * reading.problem.noise * torch.ones_like(found.residual)
        noise = likelihood.noise(replace(found, residual=residual))[0] - quadrature
        most = torch.minimum(residual.square().mean((0, 1)), reading.problem.noise.square())
        torch.testing.assert_close(noise, TOLERATED * most)


def test_rows_of_a_quadrotor_answer_to_recorded_rotor_speeds():
    reading = readings_of(flight(), Simulator(racer()), Gap())[0]
    effect = FittedEffect(effect_by_key("quadrotor", "inertia_error"), {"ratio": 2.0})
    factor = reading.problem.factor(reading.nominal.with_effects((effect,)))
    names = [channel.name for channel in channels_on(reading.nominal, reading.problem.blocks)]
    turned = [each for name, each in zip(names, factor.tolist(), strict=True) if name.startswith("torque")]
    assert turned == pytest.approx([2.0] * 3, rel=0.05)


def test_residuals_of_a_quadrotor_are_measured_against_the_same_energy_under_every_timing():
    """What the nominal simulator leaves depends on the timing: measured against it, the worst one would gain most."""
    every = readings_of(flight(("rotor_drag", 0.35)), Simulator(racer()), Gap(effects=[]))
    energies = [each.likelihood_of.energy(each.nominal) for each in every]
    assert len(energies) == 2
    torch.testing.assert_close(*energies)


def test_what_is_small_on_one_side_alone_is_no_merit():
    """An axis that drags and is shaken: by the commands, an inertia that does not feel the shaking is nearly right."""
    recording, simulator = shaken()
    reading = readings_of(recording, simulator, Gap())[0]
    dragged = with_effects(reading.nominal, viscous_friction={"coefficient": DRAG})
    light = with_effects(dragged, inertia_error={"ratio": 0.1})
    fits = [fitted_as(each, reading.problem) for each in (dragged, light)]
    by_commands, by_motion = (
        [float((each.residual / size(each)).square().mean()) for each in fits]
        for size in (lambda each: 1.0, lambda each: reading.problem.factor(each.simulator))
    )
    assert by_commands[1] < 0.1 * by_commands[0]
    assert by_motion[1] == pytest.approx(by_motion[0], rel=0.2)
    values = [reading.likelihood_of(each).value for each in fits]
    assert values[1] - values[0] < 1.0


def test_an_energy_is_that_of_the_smaller_side():
    """Of a hypothesis that adds friction without bounds it is that of the commands."""
    reading = read(Plant(friction=0.3))
    of = LikelihoodOf(reading.problem, reading.nominal)
    rubbed = (
        with_effects(reading.nominal, viscous_friction={"coefficient": size}) for size in (0.0, 1e3, 1e4)
    )
    plain, much, more = (of.energy(each) for each in rubbed)
    torch.testing.assert_close(much, more)
    assert bool((plain <= much).all())
    assert bool((plain > reading.problem.residual(reading.nominal).square().mean((0, 1))).all())


def test_a_scale_of_a_noisy_effort_is_not_shrunk_by_its_noise():
    """A regression of the motion on the effort would find the scale times signal over signal and noise."""
    recording, simulator = driven_by_effort(short(Plant(friction=0.0)))
    frame = recording.frame.copy()
    effort = frame["effort"].to_numpy()
    noise = 0.5 * effort.std() * np.random.default_rng(0).standard_normal(len(effort) // 20 + 1).repeat(20)
    frame["effort"] = effort + noise[: len(effort)]
    reading = readings_of(replace(recording, frame=frame), simulator, Gap())[0]
    scaled = fit(with_effects(reading.nominal, input_scale_error={"ratio": 0.9}), reading.problem)
    assert scaled.simulator.free[0].values["ratio"] > 0.97


def test_an_inertia_is_not_grown_by_the_noise_of_rotor_speeds():
    """A regression of the rates on the torques would find a machine that hardly answers."""
    recording = flight()
    frame, random = recording.frame.copy(), np.random.default_rng(0)
    for column in (f"motor_command_{rotor}" for rotor in range(1, 5)):
        noise = 0.05 * random.standard_normal(len(frame) // 20 + 1).repeat(20)
        frame[column] = (frame[column] + noise[: len(frame)]).clip(0.0, 1.0)
    noisy = replace(recording, frame=frame.drop(columns=[c for c in frame if c.startswith("motor_speed")]))
    reading = readings_of(noisy, Simulator(racer()), Gap())[0]
    effect = FittedEffect(effect_by_key("quadrotor", "inertia_error"), {"ratio": 3.0})
    plain = fit(reading.nominal.with_effects((effect,)), replace(reading.problem, nominal=None))
    found = fit(reading.nominal.with_effects((effect,)), reading.problem)
    assert plain.simulator.free[0].values["ratio"] > 5.0
    assert found.simulator.free[0].values["ratio"] < 1.5


def test_what_is_left_is_told_in_the_units_of_the_rows():
    """Where rows are not put on the side of the commands, too, and noise is quiet beside a weak actuator."""
    reading = readings_of(flight(), Simulator(racer()), Gap())[0]
    problem = replace(reading.problem, nominal=None, noise=4.0 * reading.problem.noise)
    weak = FittedEffect(effect_by_key("quadrotor", "thrust_coefficient_error"), {"ratio": 0.5})
    found = fitted_as(reading.nominal.with_effects((weak,)), problem)
    likelihood = LikelihoodOf(problem, reading.nominal)(found)
    left = found.residual.square().mean(1)
    loud = left > 10.0 * likelihood.noise
    assert loud.any(0).sum() >= 3
    torch.testing.assert_close(likelihood.left[loud], left[loud])


@pytest.mark.parametrize("held", [False, True])
def test_to_listen_less_is_no_merit(held):
    """A joint at rest with a voltage that jumps from sample to sample, and a winding that would filter it."""
    random, shape = np.random.default_rng(0), (4, 1600)
    voltage, position, velocity = (size * random.standard_normal(shape) for size in (0.3, 2e-4, 2e-3))
    reading = readings_of(recording_of(voltage, position, velocity), joint_simulator(), Gap())[int(held)]
    base, filtered = (
        fitted_as(each, reading.problem)
        for each in (reading.nominal, with_effects(reading.nominal, motor_inductance={"inductance": 0.1}))
    )
    rows = [each.residual / reading.problem.factor(each.simulator) for each in (base, filtered)]
    assert rows[1].square().mean() < 0.5 * rows[0].square().mean()
    assert reading.likelihood_of(filtered).value - reading.likelihood_of(base).value < 4.0


def test_the_excess_is_one_where_only_noise_is_left():
    reading = read(Plant())
    found = reading.likelihood_of(fit(reading.nominal, reading.problem))
    assert bool((found.excess >= 1.0).all())
    assert float(found.excess.max()) < 2.0
    worse = read(Plant(friction=0.3))
    assert float(worse.likelihood_of(fit(worse.nominal, worse.problem)).excess.max()) > 100.0
    assert found.weight.shape == (len(reading.problem.blocks), 1)


@pytest.mark.parametrize("driven", [0.0, 1.0])
def test_a_joint_that_does_not_move_at_all_has_a_likelihood(driven):
    """Held by friction, or read by an encoder that is too coarse: no energy is none to divide by."""
    still = np.zeros((3, 800))
    voltage = driven * np.random.default_rng(0).standard_normal(still.shape)
    for reading in readings_of(recording_of(voltage, still, still), joint_simulator(), Gap()):
        assert np.isfinite(reading.likelihood_of(fit(reading.nominal, reading.problem)).value)


def test_what_an_estimated_driver_has_used_up_counts_as_noise_where_the_nominal_simulator_meets_the_rows(
    monkeypatch,
):
    """A machine at rest, recorded without noise: rows that are met exactly are no better than rows within the noise."""
    reading = read(Plant(friction=0.3))
    problem = reading.problem
    used_up = replace(problem, counted=None, temper=problem.temper.without(3.0 / len(problem.blocks)))
    rows = torch.zeros_like(problem.residual(reading.nominal))
    found = []
    for left in (rows, rows + problem.noise):
        monkeypatch.setattr(Problem, "residual", lambda *_, left=left: left)
        found.append(LikelihoodOf(used_up, reading.nominal).untouched)
    torch.testing.assert_close(*found)
    assert float(found[0]) > 0.0


def resting(seed: int, runs: int = 4, samples: int = 1600) -> Recording:
    """A motor without a voltage at rest, whose sensors are noisy."""
    random = np.random.default_rng(seed)
    at_rest = np.zeros((runs, samples))
    angle, rate = (size * random.standard_normal(at_rest.shape) for size in (1e-4, 0.05))
    return recording_of(at_rest, angle, rate)


@pytest.mark.parametrize("seed", range(4))
def test_a_winding_gains_nothing_by_smoothing_the_noise_of_a_motor_at_rest(seed):
    """Held commands hold no noise; the back-EMF beside them does."""
    light = Simulator(replace(joint_simulator().platform, inertia=5e-4))
    reading = readings_of(resting(seed), light, Gap())[1]
    plain, late = (
        reading.likelihood_of(fitted_as(with_effects(reading.nominal, **values), reading.problem)).value
        for values in ({}, {"motor_inductance": {"inductance": 0.03}})
    )
    assert late < plain + 0.1
