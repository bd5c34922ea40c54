import inspect
from pathlib import Path
from string import Formatter

import pytest

from simgap.effects import CommandEffect, MeasurementEffect, ParameterError, effect_by_key, effects_of
from simgap.errors import InputError
from tests.pipeline.platforms.machines import EVERY_EFFECT, MACHINES, identity

EFFECT = pytest.mark.parametrize("effect", EVERY_EFFECT, ids=identity)
PLACES = {
    "quadrotor": {"command", "actuator", "force", "torque", "measurement"},
    "joint": {"command", "actuator", "force", "torque", "measurement"},
    "swerve": {"drive", "steer", "chassis", "measurement"},
}


@pytest.mark.parametrize("kind", list(MACHINES))
def test_the_listing_of_the_folder_is_the_catalogue(kind):
    effects = effects_of(kind)
    folder = Path(inspect.getfile(type(effects[0]))).parent
    files = {path.stem for path in folder.glob("*.py")} - {"__init__", "common"}
    assert {effect.name for effect in effects} == files
    keys = [effect.key for effect in effects]
    assert keys == sorted(set(keys))


@EFFECT
def test_an_effect_is_in_the_file_of_its_name(effect):
    assert type(effect).__module__ == f"simgap.effects.{effect.kind}.{effect.name}"
    assert effect_by_key(effect.kind, effect.key) is effect


@EFFECT
def test_everything_is_said_about_an_effect(effect):
    said = (
        effect.formula,
        effect.source,
        effect.sentence,
        effect.symptom,
        effect.excitation,
        type(effect).__doc__,
    )
    for text in said:
        assert text
        assert text.strip() == text
        assert "\n" not in text
    assert effect.sentence.endswith(".")
    assert effect.symptom.endswith(".")
    assert not effect.excitation.endswith(".")
    assert effect.parameters
    assert effect.acts_on in PLACES[effect.kind]


@EFFECT
def test_the_place_of_an_effect_is_its_type(effect):
    if effect.kind != "swerve":
        commands = effect.acts_on == "command"
        if not isinstance(effect, ParameterError):  # a number acts where it is used, as a map or not
            assert commands == isinstance(effect, CommandEffect)
        assert (effect.acts_on == "measurement") == isinstance(effect, MeasurementEffect)
    assert effect.name.endswith("_error") == isinstance(effect, ParameterError)


@EFFECT
def test_the_sentence_names_parameters_that_exist_and_can_be_filled(effect):
    names = {parameter.name for parameter in effect.parameters}
    placeholders = {name for _, name, _, _ in Formatter().parse(effect.sentence) if name is not None}
    assert placeholders <= names | {f"{name}_unit" for name in names}
    assert placeholders & names
    for unit in ("rad", "m"):
        said = effect.statement(effect.defaults(), unit)
        assert "{" not in said
        assert all(
            f"{value:.3g}" in said for name, value in effect.defaults().items() if name in placeholders
        )


@EFFECT
def test_the_formula_is_written_in_the_parameters(effect):
    for parameter in effect.parameters:
        assert parameter.name in effect.formula


@EFFECT
def test_bounds_hold_the_default_the_neutral_value_and_every_start(effect):
    for parameter in effect.parameters:
        assert parameter.low < parameter.high
        assert parameter.unit
        for value in (parameter.default, parameter.neutral):
            assert parameter.low <= value <= parameter.high
        assert parameter.default != parameter.neutral
    bounds = {parameter.name: (parameter.low, parameter.high) for parameter in effect.parameters}
    for start in effect.starts():
        assert start.keys() == bounds.keys()
        assert all(bounds[name][0] <= value <= bounds[name][1] for name, value in start.items())


@EFFECT
def test_a_typing_error_is_met_with_the_nearest_name(effect):
    mistyped = effect.key.replace("_", "", 1) if "_" in effect.key else effect.key[:-1]
    with pytest.raises(InputError) as caught:
        effect_by_key(effect.kind, mistyped)
    assert f"did you mean {effect.key!r}?" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", list(MACHINES))
def test_a_name_like_no_other_is_met_with_what_is_known(kind):
    with pytest.raises(InputError, match=f"unknown effect 'xyzzy' for a {kind}; known: ") as caught:
        effect_by_key(kind, "xyzzy")
    assert all(effect.key in str(caught.value) for effect in effects_of(kind))


def test_a_sliding_joint_is_spoken_of_in_newtons_and_metres():
    friction = effect_by_key("joint", "viscous_friction")
    assert friction.units("rad") == {"coefficient": "N·m·s/rad"}
    assert friction.units("m") == {"coefficient": "N·s/m"}
    assert "2 N·s/m" in friction.statement({"coefficient": 2.0}, "m")
