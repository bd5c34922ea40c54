"""The catalogue as `simgap effects` shows it, and as the documentation has it."""

from pathlib import Path

import pytest

from simgap.artifacts import PROJECT_ROOT
from simgap.effects import effects_of, kinds
from simgap.effects.page import catalogue_page
from simgap.stages.effects import main


def shown(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    said = capsys.readouterr()
    assert (ended.value.code, said.err) == (0, "")
    return said.out


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    said = capsys.readouterr()
    assert (ended.value.code, said.out) == (2, "")
    return said.err


def test_the_page_of_the_documentation_is_what_the_command_writes(tmp_path, capsys):
    written = tmp_path / "effects.md"
    assert shown(capsys, "--write", str(written)) == f"effects: wrote {written}\n"
    remedy = "the catalogue has changed: simgap effects --write docs/effects.md"
    assert (PROJECT_ROOT / "docs" / "effects.md").read_text(encoding="utf-8") == written.read_text(
        encoding="utf-8"
    ), remedy


def test_without_a_kind_every_effect_is_listed(capsys):
    lines = shown(capsys).splitlines()
    first = [line.split() for line in lines]
    for kind in kinds():
        named = {effect.name for effect in effects_of(kind) if effect.names_physics}
        assert any(line.startswith(f"{kind}: a diagnosis names {len(named)} effects") for line in lines)
        for effect in effects_of(kind):
            assert [effect.key, effect.acts_on] in [words[:2] for words in first]


def test_a_kind_is_listed_alone(capsys):
    text = shown(capsys, "joint")
    assert "coulomb_friction  " in text
    assert "rotor_drag" not in text


def test_a_name_in_two_groups_shows_both(capsys):
    text = shown(capsys, "swerve", "coulomb_friction")
    assert "swerve coulomb_friction@drive\n" in text
    assert "swerve coulomb_friction@steer\n" in text
    assert "coulomb_friction@drive" not in shown(capsys, "swerve", "coulomb_friction@steer")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("joints",), "unknown kind 'joints'; did you mean 'joint'?"),
        (
            ("rotor_drag",),
            "unknown kind 'rotor_drag'; name a kind first: simgap effects quadrotor rotor_drag",
        ),
        (("xyzzy",), "unknown kind 'xyzzy'; use one of joint, quadrotor, swerve"),
        (
            ("quadrotor", "roto_drag"),
            "effects: unknown effect 'roto_drag' for a quadrotor; did you mean 'rotor_drag'?",
        ),
    ],
)
def test_a_mistake_is_answered_in_one_line(arguments, said, capsys):
    assert refused(capsys, *arguments) == f"simgap effects: {said}\n"


def test_a_place_that_cannot_be_written_is_named(tmp_path, capsys):
    nowhere = Path(tmp_path) / "missing" / "effects.md"
    assert refused(capsys, "--write", str(nowhere)).startswith(f"simgap effects: {nowhere}: ")


def test_every_link_of_the_page_leads_to_a_section():
    page = catalogue_page()
    titles = {line[4:] for line in page.splitlines() if line.startswith("### ")}
    anchors = {title.replace("@", "").replace(" ", "-") for title in titles}
    links = {part.partition(")")[0] for part in page.split("](#")[1:]}
    assert links == anchors
    assert len(links) == sum(len(effects_of(kind)) for kind in kinds())
