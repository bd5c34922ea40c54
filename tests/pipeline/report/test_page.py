import json
import re
import shutil
from pathlib import Path

import pytest

from simgap.errors import InputError
from simgap.report import ReportInputs, write_page
from tests.pipeline.report.artifacts import HOSTILE, make_branch
from tests.pipeline.report.diagnoses import VERDICTS

ORDER = [
    "verdict",
    "where",
    "what",
    "competition",
    "fit",
    "traces",
    "laws",
    "cleaning",
    "parameters",
    "model",
]
ORDER += ["warnings", "provenance"]


def page_of(inputs: ReportInputs, folder: Path) -> str:
    write_page(inputs, folder / "page.html")
    return (folder / "page.html").read_text("utf-8")


def sections(page: str) -> list[str]:
    return re.findall(r'<section id="(\w+)">', page)


def test_the_sections_stand_in_order(tmp_path):
    page = page_of(ReportInputs.of_branch(make_branch(tmp_path), "nanodrone"), tmp_path)
    assert sections(page) == ORDER


@pytest.mark.parametrize(
    ("absent", "section"),
    [
        ("clean", "cleaning"),
        ("sysid", "parameters"),
        ("train", "model"),
        ("diagnose/evidence/traces.parquet", "traces"),
        ("diagnose/evidence/laws.json", "laws"),
        ("diagnose/evidence/competition.json", "competition"),
    ],
)
def test_a_section_without_its_artifact_is_left_out(tmp_path, absent, section):
    path = make_branch(tmp_path) / absent
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    page = page_of(ReportInputs.of_branch(tmp_path), tmp_path)
    assert sections(page) == [key for key in ORDER if key != section]


def test_where_nothing_was_trained_there_is_no_section_of_a_model(tmp_path):
    folder = make_branch(tmp_path) / "train"
    (folder / "metrics.json").write_text("{}\n")
    page = page_of(ReportInputs.of_branch(tmp_path), tmp_path)
    assert sections(page) == [key for key in ORDER if key != "model"]


def test_without_a_diagnosis_the_other_stages_are_reported(tmp_path):
    shutil.rmtree(make_branch(tmp_path) / "diagnose")
    page = page_of(ReportInputs.of_branch(tmp_path), tmp_path)
    assert sections(page) == ["cleaning", "parameters", "model", "provenance"]


@pytest.mark.parametrize("bare", [False, True])
@pytest.mark.parametrize("verdict", VERDICTS)
def test_every_verdict_has_a_page_under_8_megabytes(tmp_path, verdict, bare):
    page = page_of(ReportInputs.of_branch(make_branch(tmp_path, verdict, bare=bare)), tmp_path)
    assert f'class="verdict {verdict}"' in page
    assert len(page.encode()) < 8e6


def test_the_same_artifacts_give_the_same_bytes_wherever_they_are(tmp_path):
    pages = []
    for folder in (tmp_path / "one", tmp_path / "another"):
        pages.append(page_of(ReportInputs.of_branch(make_branch(folder), "nanodrone"), folder))
    assert pages[0] == pages[1]
    assert str(tmp_path) not in pages[0]


def test_hostile_text_is_escaped_everywhere(tmp_path):
    page = page_of(ReportInputs.of_branch(make_branch(tmp_path, text=HOSTILE), HOSTILE), tmp_path)
    assert "<script>window.hacked" not in page
    assert "<img src=x" not in page
    assert page.count("</script>") == page.count("<script")
    assert "&lt;/script&gt;&lt;script&gt;window.hacked=1" in page


def test_text_that_is_not_valid_unicode_does_not_stop_the_page(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "diagnosis.json"
    found = json.loads(path.read_text())
    found["warnings"] = ["lone \ud800 surrogate"]
    path.write_text(json.dumps(found))
    assert "lone ? surrogate" in page_of(ReportInputs.of_branch(branch), tmp_path)


def test_the_page_names_nothing_outside_itself(tmp_path):
    page = page_of(ReportInputs.of_branch(make_branch(tmp_path)), tmp_path)
    outside_scripts = re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)
    assert not re.search(r"(src|href)\s*=\s*[\"'](?!#|data:)", outside_scripts)
    assert "url(" not in outside_scripts
    assert "default-src &#39;none&#39;" in page


def test_a_diagnosis_alone_is_enough(tmp_path):
    branch = make_branch(tmp_path)
    page = page_of(ReportInputs(diagnose=branch / "diagnose"), tmp_path)
    assert sections(page) == [key for key in ORDER if key not in ("cleaning", "parameters", "model")]


def test_nothing_to_report_is_a_mistake_said_in_one_line(tmp_path):
    with pytest.raises(InputError, match="no artifacts to report"):
        write_page(ReportInputs.of_branch(tmp_path), tmp_path / "page.html")
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize(
    "file", ["diagnose/diagnosis.json", "diagnose/evidence/traces.parquet", "sysid/parameters.yaml"]
)
def test_a_damaged_artifact_is_named(tmp_path, file):
    path = make_branch(tmp_path) / file
    path.write_text("{damaged: [")
    with pytest.raises(InputError, match=path.name):
        write_page(ReportInputs.of_branch(tmp_path), tmp_path / "page.html")
