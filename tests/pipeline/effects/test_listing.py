"""What is said about an effect is what the effect says of itself."""

import pytest

from simgap.effects import effect_by_key, effects_of, kinds, look_alikes_of
from simgap.effects.listing import description, facts, listing, meaning, shown_parameters
from simgap.effects.page import catalogue_page
from tests.pipeline.platforms.machines import EVERY_EFFECT, MACHINES, identity

EFFECT = pytest.mark.parametrize("effect", EVERY_EFFECT, ids=identity)


def test_every_kind_of_machine_has_a_folder():
    assert kinds() == tuple(sorted(MACHINES))


@EFFECT
def test_an_effect_is_what_it_is_in_one_sentence(effect):
    sentence = meaning(effect)
    assert sentence.endswith(".")
    assert ". " not in sentence
    assert "|" not in sentence
    assert sentence[0].isupper()


@EFFECT
def test_everything_about_an_effect_is_described(effect):
    text = " ".join(description(effect).split())
    manoeuvre = effect.excitation[1:] + "."
    said = (
        effect.key,
        effect.acts_on,
        effect.formula,
        effect.symptom,
        effect.source,
        manoeuvre,
        *effect.needs,
    )
    for part in said:
        assert " ".join(part.split()) in text
    for parameter in effect.parameters:
        numbers = (
            f"{parameter.default:g} {parameter.unit} by default, {parameter.low:g} to {parameter.high:g}"
        )
        assert f"{parameter.name} = {numbers}" in text
        stops = parameter.neutral == 0.0 or len(effect.parameters) == 1
        assert (f"{numbers}; no effect at {parameter.neutral:g}" in text) or not stops
    stated = effect.statement(effect.defaults())
    assert (stated in text) == effect.names_physics


@EFFECT
def test_the_page_has_everything_about_an_effect(effect):
    section = catalogue_page().partition(f"### {effect.kind} {effect.key}\n")[2].partition("\n##")[0]
    assert meaning(effect) in section
    for name, text in facts(effect):
        assert name == "Look-alikes" or text in section
    for other in look_alikes_of(effect):
        assert f"[`{other.key}`](#" in section
    for p in effect.parameters:
        assert (
            f"| `{p.name}` | {p.unit} | {p.default:g} | {p.low:g} | {p.high:g} | {p.neutral:g} |" in section
        )


@pytest.mark.parametrize("kind", list(MACHINES))
def test_a_listing_has_two_lines_for_each_effect(kind):
    effects = effects_of(kind)
    lines = [line for line in listing(kind, effects).splitlines()[1:] if line]
    assert len(lines) == 2 * len(effects)
    for effect, first, second in zip(effects, lines[::2], lines[1::2], strict=True):
        assert first.split()[:2] == [effect.key, effect.acts_on]
        assert first.endswith(", ".join(shown_parameters(effect)))
        assert second.strip() == meaning(effect)


def test_of_many_parameters_the_first_ones_are_listed():
    shown = shown_parameters(effect_by_key("quadrotor", "grey_box_aerodynamics"))
    assert shown == ["linear_x_drag (1/s)", "quadratic_x_drag (1/m)", "… 27 in all"]


@EFFECT
def test_a_look_alike_exists_and_names_the_effect_too(effect):
    names = {other.name for other in effects_of(effect.kind) if other.names_physics}
    assert set(effect.look_alikes) <= names - {effect.name}
    for other in look_alikes_of(effect):
        assert effect in look_alikes_of(other)


def test_look_alikes_act_on_one_group_of_a_swerve_drive():
    like_delay = {other.key for other in look_alikes_of(effect_by_key("swerve", "command_delay@drive"))}
    assert like_delay == {"motor_inductance@drive", "sensor_time_offset@chassis"}


def test_an_effect_that_is_never_named_is_like_none():
    assert look_alikes_of(effect_by_key("quadrotor", "grey_box_aerodynamics")) == ()
