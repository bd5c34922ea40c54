"""The line of feedforward gains."""

import pytest

from simgap.api.gains import gains_line
from simgap.models.identify import Identified
from simgap.models.parameters import Parameter


def identified(**values: float) -> Identified:
    return Identified({"joint": {name: Parameter(value, "V", 0.1) for name, value in values.items()}})


def test_gains_that_a_motor_may_have_are_said_alone():
    """A load may pull either way."""
    line = gains_line(identified(kS=0.3, kV=1.0, kA=0.2, kG=-0.5))
    assert line.startswith("feedforward gains of the motor: kS 0.3")
    assert "do not use" not in line


@pytest.mark.parametrize(("wrong", "said"), [({"kS": -2.0}, "kS"), ({"kS": -2.0, "kA": -0.1}, "kS or kA")])
def test_gains_that_no_motor_has_are_not_to_be_used(wrong, said):
    line = gains_line(identified(**({"kS": 0.3, "kV": 1.0, "kA": 0.2} | wrong)))
    assert line.endswith(f". No motor has {said} below zero: do not use these gains")
