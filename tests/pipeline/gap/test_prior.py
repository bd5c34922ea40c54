"""What is believed before anything was recorded, whatever the units."""

import math
from dataclasses import replace

import pytest
import torch
from scipy import integrate

from simgap.effects import ParameterError, effect_by_key, effects_of
from simgap.equations.fit import fit
from simgap.gap.hypothesis import Hypothesis, weigh
from simgap.gap.prior import Density, densities_of, density_of, log_odds
from simgap.gap.reading import Reading, readings_of
from simgap.gap.scales import Scales
from simgap.gap.settings import Gap
from simgap.platforms import Quadrotor
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.gap.recordings import Plant, flown, joint_recordings, joint_simulator, racer
from tests.pipeline.gap.units import driven_by_effort, in_units

SCALES = Scales({"effort": 2.0, "travel": 0.5, "speed": 5.0}, {"temperature": (40.0, 5.0)})
DENSITIES = {
    "size on both sides": (Density("t", 0.3, 2.0), (-math.inf, math.inf)),
    "size on one side": (Density("t", 0.0, 0.02, sided=True), (0.0, math.inf)),
    "ratio": (Density("log", 1.0, 0.3), (0.0, math.inf)),
    "shape": (Density("log", 0.04, 1.0), (0.0, math.inf)),
    "driver": (Density("normal", 40.0, 15.0), (-math.inf, math.inf)),
    "share": (Density("uniform", 0.5, 0.8), (0.1, 0.9)),
}


def _mass(density: Density, low: float, high: float) -> float:
    """Return the integral of a density, in widths about its centre so that the quadrature finds its peak."""
    if density.family == "log":  # over the logarithm
        inner = lambda u: math.exp(density.log(math.exp(u)) + u)  # noqa: E731
        centre, unit = math.log(density.centre), density.width
        return integrate.quad(inner, centre - 12.0 * unit, centre + 12.0 * unit, limit=200)[0]
    low, high = ((end - density.centre) / density.width for end in (low, high))
    inner = lambda u: math.exp(density.log(density.centre + density.width * u)) * density.width  # noqa: E731
    return integrate.quad(inner, low, high, limit=200)[0]


@pytest.mark.parametrize("name", DENSITIES)
def test_every_density_integrates_to_one(name):
    density, (low, high) = DENSITIES[name]
    assert _mass(density, low, high) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("kind", ["joint", "quadrotor", "swerve"])
def test_every_parameter_of_the_catalogue_has_a_density(kind):
    """Proper where the effect does something, and positive at its realistic size."""
    for effect in effects_of(kind):
        for parameter, density in zip(
            effect.parameters, densities_of(FittedEffect(effect, effect.defaults()), SCALES), strict=True
        ):
            assert density.width > 0.0, (effect.key, parameter.name)
            assert math.isfinite(density.log(parameter.default)), (effect.key, parameter.name)
            assert density.precision(parameter.default) > 0.0
        assert 0.0 < effect.prior_odds < math.inf
        assert log_odds(effect, {}) == math.log(effect.prior_odds)


@pytest.mark.parametrize(
    ("name", "number"), [("linear_stiffness", "stiffness"), ("gravity_load", "gravity_torque")]
)
def test_an_error_of_a_number_of_the_platform_is_more_probable_than_physics_that_it_lacks(name, number):
    effect = effect_by_key("joint", name)
    assert log_odds(effect, {number: 0.0}) == log_odds(effect, {}) < log_odds(effect, {number: 2.0})


def test_a_ratio_and_its_inverse_are_as_probable_in_logarithms():
    effect = effect_by_key("joint", "inertia_error")
    assert isinstance(effect, ParameterError)
    density = density_of(effect, effect.parameters[0], SCALES)
    assert density.log(1.25) + math.log(1.25) == pytest.approx(density.log(0.8) + math.log(0.8))
    assert density.log(1.05) > density.log(1.5) > density.log(3.0)


@pytest.mark.parametrize("kind", ["joint", "quadrotor", "swerve"])
def test_a_share_may_have_any_value_within_its_bounds(kind):
    """A share of nothing, or a negative one, is as possible as its bounds say: a ratio's logarithm forbids it.

    Not of damage, which has a usual size.
    """
    shares = [
        (effect, parameter)
        for effect in effects_of(kind)
        for parameter in effect.parameters
        if parameter.unit == "1" and parameter.low <= 0.0 and not parameter.typical
    ]
    for effect, parameter in shares:
        density = density_of(effect, parameter, SCALES)
        values = (parameter.low, parameter.neutral, min(parameter.high, 2.0 * parameter.default))
        assert min(map(density.log, values)) > -20.0, (effect.key, parameter.name)


def test_a_size_is_measured_in_that_of_the_effort():
    """Friction of a third of the effort is usual, of ten times as much improbable and not impossible."""
    effect = effect_by_key("joint", "coulomb_friction")
    (parameter,) = effect.parameters
    density = density_of(effect, parameter, SCALES)
    assert (density.family, density.sided) == ("t", True)
    assert 0.1 * 2.0 < density.width < 2.0
    assert density.log(0.5) - density.log(20.0) > 5.0
    assert math.isfinite(density.log(2000.0))


@pytest.mark.parametrize("kind", ["joint", "quadrotor", "swerve"])
def test_a_limit_has_a_likely_decade(kind):
    """A limit that nothing gets past is as improbable as one that nothing reaches."""
    limits = [(e, p) for e in effects_of(kind) for p in e.parameters if p.is_limit]
    for effect, parameter in limits:
        density = density_of(effect, parameter, SCALES)
        assert density.family == "log", effect.key
        logs = [density.log(size * density.centre) + math.log(size) for size in (1e-3, 0.3, 1.0, 3.0, 1e3)]
        assert min(logs[1:4]) - max(logs[0], logs[4]) > 15.0, effect.key


def test_damage_is_hardly_ever_as_small_as_what_rotors_of_one_batch_differ_by():
    fault = effect_by_key("quadrotor", "rotor_fault@1")
    density = density_of(fault, fault.parameters[0], SCALES)
    found, batch = 0.2, 0.002
    assert density.log(found) + math.log(found) > density.log(batch) + math.log(batch) + 10.0


def test_a_rotor_may_take_longer_to_follow_than_a_bus_to_deliver():
    """Published rotors take 12 to 100 ms, buses and controllers some 20 ms."""
    lag, delay = (effect_by_key("quadrotor", name) for name in ("motor_lag", "command_delay"))
    rotor, bus = (density_of(effect, effect.parameters[0], SCALES) for effect in (lag, delay))
    assert rotor.log(0.07) > bus.log(0.07) + 1.0
    assert bus.log(0.005) > rotor.log(0.005) + 1.0


@pytest.mark.parametrize("name", DENSITIES)
def test_the_precision_is_the_curvature_at_the_centre(name):
    """Up to the heavier tails of a Student and the logarithm's slope; of a uniform density, its variance."""
    density, _ = DENSITIES[name]
    step = 1e-3 * density.width * (density.centre if density.family == "log" else 1.0)
    centre = density.centre
    curvature = (
        -(density.log(centre + step) - 2.0 * density.log(centre) + density.log(centre - step)) / step**2
    )
    if density.family == "normal":
        assert density.precision(centre) == pytest.approx(curvature, rel=1e-3)
    elif density.family == "t" and not density.sided:
        assert density.precision(centre) == pytest.approx(curvature, rel=0.5)
    elif density.family == "uniform":
        assert density.precision(centre) == pytest.approx(12.0 / density.width**2)


def _weighed(recording: Recording, simulator: Simulator, *names: str) -> Hypothesis:
    reading: Reading = readings_of(recording, simulator, Gap())[0]
    effects = [FittedEffect(e, e.defaults()) for e in (effect_by_key("joint", name) for name in names)]
    sized = [
        replace(f, values={p.name: (reading.scales.of(p.unit) or p.default) for p in f.effect.parameters})
        for f in effects
    ]
    return weigh(fit(reading.nominal.with_effects(tuple(sized)), reading.problem), reading)


@pytest.mark.parametrize("names", [("viscous_friction",), ("coulomb_friction", "linear_stiffness")])
@pytest.mark.parametrize(("effort", "travel"), [(1e3, 1.0), (1e-3, 1.0), (1.0, 57.3)])
def test_the_evidence_for_an_effect_does_not_depend_on_units(names, effort, travel):
    """What the density gains by the unit, the volume that the recording leaves loses."""
    plain = driven_by_effort(
        joint_recordings(Plant(friction=0.3, viscous=0.02), [0], runs=2, duration=4.0)[0]
    )
    pairs = [
        (_weighed(*given), _weighed(*given, *names))
        for given in (plain, in_units(*plain, effort=effort, travel=travel))
    ]
    (before, with_it), (scaled_before, scaled_with_it) = pairs
    assert scaled_with_it.occam == pytest.approx(with_it.occam, abs=0.05)
    assert scaled_with_it.score - scaled_before.score == pytest.approx(with_it.score - before.score, abs=0.05)
    for f, scaled in zip(with_it.fit.simulator.free, scaled_with_it.fit.simulator.free, strict=True):
        assert scaled.effect.key == f.effect.key


@pytest.mark.parametrize(
    "names",
    [("center_of_mass_offset",), ("rotor_inertia_torque",), ("blade_flapping_moment", "axial_inflow")],
)
@pytest.mark.parametrize("length", [0.2, 30.0])
def test_the_evidence_for_an_effect_does_not_depend_on_the_length_of_the_arms(names, length):
    """Arms, inertia and torques of the rotors that are so many times as large give the same motion."""
    recording = flown((), 0, 4)
    gained = []
    for machine in (racer(), _longer(racer(), length)):
        reading = readings_of(recording, Simulator(machine), Gap())[0]
        numbers, signals = reading.nominal.constants(), reading.problem.blocks.signals
        effects = [effect_by_key("quadrotor", name) for name in names]
        sized = [{p.name: p.default for p in effect.parameters_in(signals, numbers)} for effect in effects]
        with_it = reading.nominal.with_effects(tuple(map(FittedEffect, effects, sized)))
        before, after = (weigh(fit(s, reading.problem), reading) for s in (reading.nominal, with_it))
        gained.append((after.score - before.score, after.occam))
    assert gained[1] == pytest.approx(gained[0], abs=0.05)


def _longer(machine: Quadrotor, length: float) -> Quadrotor:
    """Return a quadrotor whose torques and inertia are that many times as large, and whose forces are the same."""
    return replace(
        machine,
        inertia=tuple(length * inertia for inertia in machine.inertia),
        rotor_positions=tuple(tuple(length * x for x in rotor) for rotor in machine.rotor_positions),
        torque_coefficient=length * machine.torque_coefficient,
    )


@pytest.mark.parametrize("name", ["coulomb_friction", "constant_load", "motor_inductance"])
def test_a_parameter_that_the_recording_says_nothing_of_gains_nothing(name):
    """The prior integrates to one, whichever side of its centre a parameter lies on."""
    recording = joint_recordings(Plant(), [0], runs=2, duration=4.0)[0]
    reading = readings_of(recording, joint_simulator(), Gap())[1]
    effect = effect_by_key("joint", name)
    values = {p.name: 1e-3 * p.default for p in effect.parameters}
    found = fit(reading.nominal.with_effects((FittedEffect(effect, values),)), reading.problem)
    silent = replace(
        found,
        simulator=found.simulator.with_effects((FittedEffect(effect, values),)),
        jacobian=torch.zeros_like(found.jacobian),
    )
    assert weigh(silent, reading).occam == pytest.approx(0.0, abs=0.15)
