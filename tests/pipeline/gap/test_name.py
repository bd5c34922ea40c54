"""The order of names."""

from simgap.effects import effect_by_key
from simgap.gap.name import Named, in_order
from simgap.simulation import FittedEffect


def entry(name: str, probability: float, share: float) -> Named:
    effect = effect_by_key("joint", name)
    return Named(FittedEffect(effect, effect.defaults()), probability, 0, share)


def test_the_most_probable_name_comes_first():
    found = [entry("cubic_stiffness", 0.7, 0.9), entry("coulomb_friction", 0.8, 0.1)]
    assert [each.effect.name for each in in_order(found)] == ["coulomb_friction", "cubic_stiffness"]


def test_of_equally_sure_names_friction_comes_last_and_then_what_explains_less():
    """Every joint has some friction, whatever else is missing."""
    found = [
        entry("viscous_friction", 0.98, 0.9),
        entry("linear_stiffness", 0.98, 0.1),
        entry("cubic_stiffness", 0.98, 0.3),
    ]
    expected = ["cubic_stiffness", "linear_stiffness", "viscous_friction"]
    assert [each.effect.name for each in in_order(found)] == expected
