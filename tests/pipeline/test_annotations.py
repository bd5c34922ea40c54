"""Under test, what is annotated is checked: a wrong type or shape ends the call."""

import pytest
import torch
from jaxtyping import TypeCheckError

from simgap.effects import Parameter, effect_by_key
from simgap.physics import rotations
from simgap.simulation.blocks import Blocks


def test_a_wrong_type_is_refused():
    with pytest.raises(TypeCheckError, match="Type-check error"):
        effect_by_key(3, "rotor_drag")


@pytest.mark.parametrize("arguments", [("width", "m", "wide", 0.0, 1.0), (1, "m", 0.5, 0.0, 1.0)])
def test_a_wrong_type_of_a_field_is_refused(arguments):
    with pytest.raises(TypeCheckError, match="Type-check error"):
        Parameter(*arguments)


def test_a_wrong_type_is_refused_by_a_method():
    blocks = Blocks({}, torch.zeros(1, dtype=torch.long), ("run",), torch.zeros(1), 0.01, 1, 10)
    with pytest.raises(TypeCheckError, match="Type-check error"):
        blocks.inner([1.0])


def test_a_wrong_shape_is_refused():
    with pytest.raises(TypeCheckError):
        rotations.normalize(torch.zeros(3))
