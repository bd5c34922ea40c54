"""The picture of the pipeline is that of dvc.yaml."""

from xml.etree import ElementTree

import pytest

from simgap.runner.pipeline import Step, steps
from tools.pipeline_picture import GROUPS, PLACES, ROOT, arrows, picture


def test_the_picture_in_the_documentation_is_that_of_the_pipeline() -> None:
    drawn = (ROOT / "docs/images/pipeline.svg").read_text(encoding="utf-8")
    assert drawn == picture(steps(ROOT)), "python -m tools.pipeline_picture docs/images/pipeline.svg"


def test_every_stage_has_a_place_of_its_own_in_a_group() -> None:
    assert set(PLACES) == {step.name for step in steps(ROOT)}
    assert len({place[:2] for place in PLACES.values()}) == len(PLACES)
    columns = {column for first, last in GROUPS.values() for column in range(first, last + 1)}
    assert {place[0] for place in PLACES.values()} <= columns


def test_no_line_runs_through_a_box() -> None:
    taken = {place[:2] for place in PLACES.values()}
    for source, target in arrows(steps(ROOT)):
        (column, row, _), (to_column, to_row, _) = PLACES[source], PLACES[target]
        assert to_column > column or (to_column == column and to_row > row)
        if to_column == column:
            passed = {(column, between) for between in range(row + 1, to_row)}
        elif to_column == column + 1:
            passed = set()
        elif to_row == row:
            passed = {(between, row) for between in range(column + 1, to_column)}
        else:
            assert row > to_row
            passed = {(between, row) for between in range(column + 1, to_column + 1)}
            passed |= {(to_column, between) for between in range(to_row + 1, row)}
        assert not passed & taken


def test_what_follows_from_other_arrows_is_left_out() -> None:
    chain = [Step("a", ()), Step("b", ("a",)), Step("c", ("a", "b")), Step("d", ("a", "c"))]
    assert arrows(chain) == [("a", "b"), ("b", "c"), ("c", "d")]


def test_it_is_well_formed_and_fits_a_page() -> None:
    root = ElementTree.fromstring(picture(steps(ROOT)))
    assert int(root.attrib["width"]) <= 800


def test_a_stage_without_a_place_is_not_drawn_somewhere() -> None:
    with pytest.raises(KeyError):
        picture([*steps(ROOT), Step("stray", ("report",))])
