"""A name that leaves open which rotor, module, sensor or group is meant comes with its subject."""

import pytest

from simgap.effects import effect_by_key, effects_of, kinds


def subject(kind, key, **values):
    effect = effect_by_key(kind, key)
    return effect.subject({**effect.neutral(), **values})


@pytest.mark.parametrize(
    ("kind", "key", "said"),
    [
        ("quadrotor", "rotor_fault@3", "3"),
        ("quadrotor", "rotor_drag", ""),
        ("quadrotor", "sensor_time_offset", "state"),
        ("joint", "coulomb_friction", ""),
        ("joint", "sensor_time_offset", "position and velocity"),
        ("swerve", "viscous_friction@drive", "drive"),
        ("swerve", "viscous_friction@steer", "steer"),
        ("swerve", "backlash@steer", "steer"),
        ("swerve", "mass_error@drive", ""),
        ("swerve", "slope@chassis", ""),
        ("swerve", "sensor_time_offset@chassis", "motion"),
    ],
)
def test_what_a_name_is_about(kind, key, said):
    assert subject(kind, key) == said


@pytest.mark.parametrize(
    ("offsets", "said"),
    [
        ((0.0, 0.0, 0.0, 0.0), ""),
        ((0.01, -0.3, 0.02, 0.0), "2"),
        ((0.2, 0.0, 0.0, 0.15), ""),
        ((0.1, 0.1, 0.1, 0.1), ""),
    ],
)
def test_one_module_that_stands_out_is_the_subject(offsets, said):
    values = {f"offset_{module}": offset for module, offset in enumerate(offsets, start=1)}
    assert subject("swerve", "module_misalignment@chassis", **values) == said


def test_two_entries_of_one_name_have_two_subjects():
    for kind in kinds():
        entries = [(effect.name, effect.subject(effect.defaults())) for effect in effects_of(kind)]
        assert len(set(entries)) == len(entries)
