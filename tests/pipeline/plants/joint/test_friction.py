import numpy as np
import pytest

from simgap.plants.concealment import Concealed
from simgap.plants.joint.effects import CONCEALABLE, OUTSIDE
from simgap.plants.joint.friction import friction_of

SIZE = {"effort": 1.0, "position": 1.0, "velocity": 1.0, "current": 1.0}
STEP = 1e-3
STILL = np.zeros(1)


def friction(effects, outside=()):
    return friction_of(
        Concealed(effects, CONCEALABLE, SIZE), Concealed(dict(outside), OUTSIDE, SIZE), 0.02, effort=1.0
    )


def followed(law, velocities):
    """Return the dry friction (steps,) along velocities (steps,)."""
    deflection, forces, position = STILL, [], 0.0
    for speed in velocities:
        velocity = np.array([speed])
        position += STEP * speed
        level = law.level(velocity, np.array([position]), STILL, STILL)
        deflection = law.bend(deflection, velocity, level, STEP)
        forces.append(law.dry_force(deflection, velocity, level)[0])
    return np.array(forces)


@pytest.mark.parametrize("speed", [0.3, -0.3, 4.0])
def test_sliding_friction_is_at_its_level(speed):
    law = friction({"coulomb_friction": {"level": 0.2}})
    assert followed(law, np.full(300, speed))[-1] == pytest.approx(-0.2 * np.sign(speed), rel=1e-9)


def test_the_stribeck_extra_fades_with_speed():
    law = friction(
        {"coulomb_friction": {"level": 0.2}, "stribeck_friction": {"extra_level": 0.1, "velocity": 0.5}}
    )
    for speed, level in ((0.01, 0.3), (0.5, 0.2 + 0.1 / np.e), (5.0, 0.2)):
        assert -followed(law, np.full(3000, speed))[-1] == pytest.approx(level, rel=1e-3)


def test_the_difference_counts_in_the_direction_of_its_sign():
    law = friction({"coulomb_friction": {"level": 0.2}, "asymmetric_friction": {"difference": -0.1}})
    assert followed(law, np.full(300, -1.0))[-1] == pytest.approx(0.3)
    assert followed(law, np.full(300, 1.0))[-1] == pytest.approx(-0.2)


def test_a_tight_spot_is_tight_in_its_place_alone():
    law = friction({}, {"tight_spot": {"level": 0.5, "place": 1.0, "width": 0.1}})
    at = [law.level(STILL, np.array([place]), STILL, STILL)[0] for place in (0.0, 1.0)]
    assert at == pytest.approx([0.0, 0.5], abs=1e-6)


def test_load_presses_and_wear_grows():
    law = friction({"load_dependent_friction": {"ratio": 0.2}}, {"wear": {"growth": 0.01}})
    assert law.level(STILL, STILL, np.array([-3.0]), np.array([10.0]))[0] == pytest.approx(0.7)


def test_friction_takes_energy_over_any_closed_motion():
    everything = {name: {} for name in CONCEALABLE if name.endswith("friction")}
    law = friction(everything)
    random = np.random.default_rng(0)
    times = np.arange(0.0, 4.0, STEP)
    for _ in range(5):
        lines = random.uniform(0.5, 4.0, 4).round() * np.pi
        velocity = sum(np.cos(line * times + random.uniform(0, 6)) for line in lines)
        dry = followed(law, velocity)
        assert (dry * velocity).sum() * STEP < 0
        assert (law.speed_force(velocity) * velocity <= 0).all()


def test_bristles_hold_what_is_below_the_level():
    """A push under the level moves a mass by a few bends of its bristles (they creep while they swing in), no more."""
    law, inertia = friction({"coulomb_friction": {"level": 0.2}}), 0.02
    velocity, deflection, position = STILL, STILL, 0.0
    for _ in range(2000):
        level = law.level(velocity, STILL, STILL, STILL)
        force = 0.15 + law.dry_force(deflection, velocity, level)
        velocity = velocity + STEP * force / inertia
        deflection = law.bend(deflection, velocity, level, STEP)
        position += STEP * velocity[0]
    assert abs(position) < 5 * 0.2 / law.stiffness
    assert abs(velocity[0]) < 1e-3
