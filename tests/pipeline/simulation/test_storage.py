import math

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.effects import effects_of
from simgap.errors import InputError
from simgap.simulation import FittedEffect, Simulator, read_simulator, write_simulator
from tests.pipeline.platforms.machines import MACHINES


@st.composite
def parts(draw: st.DrawFn) -> tuple:
    """Draw what a simulator is made of; it is put together outside, since its type checks draw random numbers."""
    kind = draw(st.sampled_from(list(MACHINES)))
    chosen = draw(
        st.lists(st.sampled_from(effects_of(kind)), unique_by=lambda effect: effect.key, max_size=5)
    )
    effects = []
    for effect in chosen:
        values = {p.name: draw(st.floats(p.low, p.high)) for p in effect.parameters}
        std = {name: draw(st.floats(0.0, 1e3)) for name in values} if draw(st.booleans()) else {}
        effects.append((effect, values, std, draw(st.booleans())))
    unit = draw(st.sampled_from(["rad", "m"])) if kind == "joint" else "rad"
    constants = draw(st.dictionaries(st.just("sliding_velocity"), st.floats(1e-4, 1.0)))
    return kind, effects, unit, constants


@given(parts=parts())
@settings(max_examples=40)
def test_a_simulator_comes_back_as_it_was_written(parts, tmp_path_factory):
    kind, effects, unit, constants = parts
    simulator = Simulator(MACHINES[kind], tuple(FittedEffect(*effect) for effect in effects), unit, constants)
    folder = tmp_path_factory.mktemp("stored") / "simulator"
    write_simulator(simulator, folder)
    assert read_simulator(folder) == simulator
    first = (folder / "simulator.yaml").read_bytes()
    write_simulator(read_simulator(folder), folder)
    assert (folder / "simulator.yaml").read_bytes() == first


def written(tmp_path, kind: str = "joint") -> dict:
    """Write a simulator with every effect of a kind, and return what the file says."""
    effects = tuple(FittedEffect(e, e.defaults(), e.defaults(), known=True) for e in effects_of(kind))
    write_simulator(Simulator(MACHINES[kind], effects, settings={"sliding_velocity": 0.02}), tmp_path)
    return yaml.safe_load((tmp_path / "simulator.yaml").read_text("utf-8"))


def refusal(tmp_path, text: str) -> str:
    (tmp_path / "simulator.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        read_simulator(tmp_path)
    message = str(caught.value)
    assert "\n" not in message
    assert str(tmp_path / "simulator.yaml") in message or "unknown effect" in message
    return message


@pytest.mark.parametrize("kind", list(MACHINES))
def test_the_file_says_units_and_formulas_to_a_person(tmp_path, kind):
    content = written(tmp_path, kind)
    for described, effect in zip(content["effects"], effects_of(kind), strict=True):
        assert described["formula"] == effect.formula
        for parameter in effect.parameters:
            assert described["parameters"][parameter.name]["unit"] == parameter.unit


def test_what_is_known_before_and_what_was_fitted_are_told_apart(tmp_path):
    first, second = effects_of("joint")[:2]
    effects = (FittedEffect(first, first.defaults(), known=True), FittedEffect(second, second.defaults()))
    write_simulator(Simulator(MACHINES["joint"], effects), tmp_path)
    read = read_simulator(tmp_path)
    assert read.known == (effects[0],)
    assert read.free == (effects[1],)


@pytest.mark.parametrize(
    "tag",
    [
        "!!python/object/apply:os.system ['true']",
        "!!python/name:os.system",
        "!!python/object:object {}",
        "!anything {}",
    ],
)
def test_a_file_that_wants_something_run_is_refused(tmp_path, tag):
    written(tmp_path)
    text = (
        (tmp_path / "simulator.yaml")
        .read_text("utf-8")
        .replace("position_unit: rad", f"position_unit: {tag}")
    )
    assert "no simulator can be read" in refusal(tmp_path, text)


def test_a_missing_file_and_a_missing_folder_are_said(tmp_path):
    for folder in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(InputError, match="no simulator can be read") as caught:
            read_simulator(folder)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    "text", ["", "[]", "schema: simgap.simulator/2", "just text", "a: b: c", "\x00", "{"]
)
def test_what_is_no_simulator_is_refused(tmp_path, text):
    refusal(tmp_path, text)


def test_bytes_that_are_no_text_are_refused(tmp_path):
    (tmp_path / "simulator.yaml").write_bytes(b"\xff\xfe\x00schema")
    with pytest.raises(InputError, match="no simulator can be read"):
        read_simulator(tmp_path)


@pytest.mark.parametrize("key", ["schema", "position_unit", "platform", "settings", "effects"])
@pytest.mark.parametrize("value", [None, "text", 3, [1], {"a": "b"}], ids=str)
def test_every_key_that_was_tampered_with_is_refused_in_one_line(tmp_path, key, value):
    content = written(tmp_path)
    refusal(tmp_path, yaml.safe_dump(content | {key: value}))
    del content[key]
    refusal(tmp_path, yaml.safe_dump(content))


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("effect", "coulomb_fricton", "did you mean 'coulomb_friction'?"),
        ("effect", None, "unknown effect"),
        ("parameters", {}, "has the parameters"),
        ("parameters", {"nonsense": {"value": 1.0}}, "has the parameters"),
        ("parameters", {"level": {"value": "much"}}, "could not convert"),
        ("parameters", {"level": {"value": math.nan}}, "not a finite number"),
        ("parameters", {"level": {"value": True}}, "not a finite number"),
        ("parameters", {"level": 1.0}, "is damaged"),
        ("parameters", {"level": {"value": 1.0, "std": "wide"}}, "is damaged"),
        ("parameters", None, "is damaged"),
    ],
)
def test_every_part_of_an_effect_that_was_tampered_with_is_refused(tmp_path, key, value, said):
    content = written(tmp_path)
    entry = next(entry for entry in content["effects"] if entry["effect"] == "coulomb_friction")
    entry[key] = value
    assert said in refusal(tmp_path, yaml.safe_dump(content))


def test_an_effect_that_is_there_twice_is_refused(tmp_path):
    content = written(tmp_path)
    content["effects"].append(content["effects"][0])
    assert f"{content['effects'][0]['effect']} is there twice" in refusal(tmp_path, yaml.safe_dump(content))
