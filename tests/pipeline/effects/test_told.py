"""A number whose error is as large as itself is no number."""

import pytest

from simgap.effects.told import is_told


def effect(name: str, **parameters: tuple[float | None, float | None]) -> dict:
    entries = {key: {"value": value, "std": std, "unit": "1"} for key, (value, std) in parameters.items()}
    return {"name": name, "parameters": entries}


@pytest.mark.parametrize(
    ("found", "told"),
    [
        (effect("dead_zone", width=(21.0, 110.0)), False),
        (effect("command_delay", delay=(0.14, 0.25)), False),
        (effect("inertia_error", ratio=(0.29, 0.38)), False),
        (effect("inertia_error", ratio=(1.02, 0.05)), False),
        (effect("inertia_error", ratio=(1.2, 0.05)), True),
        (effect("coulomb_friction", level=(-0.3, 0.2)), True),
        (effect("gravity_load", sine=(0.01, 0.04), cosine=(-0.46, 0.04)), True),  # one of both is known
        (effect("dead_zone", width=(0.2, None)), True),  # an error that nobody knows
        (effect("dead_zone", width=(None, None)), False),
    ],
)
def test_a_size_is_told_where_a_parameter_is_beyond_its_error(found, told):
    assert is_told(found) == told
