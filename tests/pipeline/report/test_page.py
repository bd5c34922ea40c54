import json
import re
import shutil
from pathlib import Path

import pandas as pd
import pytest

from simgap.errors import InputError
from simgap.report import ReportInputs, write_page
from tests.pipeline.report.artifacts import HOSTILE, make_branch
from tests.pipeline.report.diagnoses import DOUBTED, VERDICTS

ORDER = [
    "verdict",
    "what",
    "sure",
    "where",
    "fit",
    "traces",
    "laws",
    "cleaning",
    "parameters",
    "model",
]
ORDER += ["warnings", "provenance", "use"]


MOST_BYTES = 1.5e6


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
    ],
)
def test_a_section_without_its_artifact_is_left_out(tmp_path, absent, section):
    path = make_branch(tmp_path) / absent
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    page = page_of(ReportInputs.of_branch(tmp_path), tmp_path)
    assert sections(page) == [key for key in ORDER if key != section]


def test_without_candidates_and_hypotheses_there_is_no_section_of_how_sure(tmp_path):
    evidence = make_branch(tmp_path) / "diagnose" / "evidence"
    (evidence / "hypotheses.json").unlink()
    assert sections(page_of(ReportInputs.of_branch(tmp_path), tmp_path)) == ORDER
    (evidence / "candidates.json").unlink()
    without = [key for key in ORDER if key != "sure"]
    assert sections(page_of(ReportInputs.of_branch(tmp_path), tmp_path)) == without


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
def test_every_verdict_has_a_page_under_one_and_a_half_megabytes(tmp_path, verdict, bare):
    page = page_of(ReportInputs.of_branch(make_branch(tmp_path, verdict, bare=bare)), tmp_path)
    assert f'class="verdict {verdict}"' in page
    assert len(page.encode()) < MOST_BYTES


def test_the_page_says_which_rotor_a_fault_is_about(tmp_path):
    path = make_branch(tmp_path) / "diagnose" / "diagnosis.json"
    found = json.loads(path.read_text())
    found["effects"][0] |= {"name": "rotor_fault", "subject": "3"}
    found["ambiguous"] = [
        {"names": ["rotor_fault", "steady_wind"], "subjects": ["3", None], "separate_by": "Hover and turn."}
    ]
    path.write_text(json.dumps(found))
    page = page_of(ReportInputs.of_branch(tmp_path), tmp_path)
    assert "<strong>rotor fault (rotor 3)</strong>: " in page  # the verdict
    assert "<strong>rotor fault</strong> (rotor 3)<br>" in page  # the table
    assert "<strong>rotor fault (rotor 3) or steady wind</strong>: Hover and turn." in page
    assert "To tell rotor fault (rotor 3) and steady wind apart" in page


def test_one_held_out_run_has_no_interval_and_no_bands(tmp_path):
    folder = make_branch(tmp_path) / "diagnose"
    path, curves = folder / "diagnosis.json", folder / "evidence" / "horizon.json"
    found, horizons = json.loads(path.read_text()), json.loads(curves.read_text())
    found["fit"] |= {"held_out_runs": ["melon_run1"], "gap_closed_interval": None}
    for entry in horizons:
        entry |= {key: [None] * len(entry["horizon"]) for key in entry if key.endswith(("_low", "_high"))}
    path.write_text(json.dumps(found))
    curves.write_text(json.dumps(horizons))
    page = page_of(ReportInputs.of_branch(tmp_path), tmp_path)
    assert "(one run: no interval)" in page
    assert "One run: no interval." in page
    assert "95\u202f% interval" not in page.partition('<section id="traces">')[0]
    assert "bootstrap intervals" not in page


def test_a_page_full_of_evidence_stays_under_the_bound(tmp_path):
    branch = make_branch(tmp_path)
    evidence = branch / "diagnose" / "evidence"
    traces = pd.read_parquet(evidence / "traces.parquet")
    many = [traces.assign(run=[f"{run}_{k}" for run in traces["run"]]) for k in range(8)]
    pd.concat(many).to_parquet(evidence / "traces.parquet")
    laws = json.loads((evidence / "laws.json").read_text())
    (evidence / "laws.json").write_text(json.dumps(laws * 12))
    page = page_of(ReportInputs.of_branch(branch), tmp_path)
    assert page.count('class="figure"') == 26
    assert len(page.encode()) < MOST_BYTES


def test_a_contradiction_leaves_out_what_rests_on_names(tmp_path):
    page = page_of(ReportInputs.of_branch(make_branch(tmp_path, "contradiction")), tmp_path)
    assert sections(page) == ["verdict", "traces", "cleaning", "warnings", "provenance", "use"]
    assert "Suspected: voltage (another sign or frame)" in page
    assert "Compare the sign of &#39;voltage&#39; with the platform file." in page
    assert "nexplained" not in page
    assert "of the gap" not in page


def test_a_minus_is_one_sign_on_the_whole_page(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "diagnosis.json"
    found = json.loads(path.read_text())
    found["effects"].append(DOUBTED)
    found["warnings"].append("late by -0.153 s (correlation -0.99)")
    path.write_text(json.dumps(found))
    page = page_of(ReportInputs.of_branch(branch), tmp_path)
    seen = re.sub(r"<(style|script).*?</\1>|<[^>]*>", "", page, flags=re.DOTALL)
    assert not re.findall(r".{20}(?<![\w)])-\d.{10}", seen)
    assert "−0.153 s (correlation −0.99)" in seen
    assert "−0.0123" in seen


def test_what_is_doubted_stands_under_perhaps(tmp_path):
    branch = make_branch(tmp_path)
    path = branch / "diagnose" / "diagnosis.json"
    found = json.loads(path.read_text())
    found["effects"].append(DOUBTED)
    path.write_text(json.dumps(found))
    page = page_of(ReportInputs.of_branch(branch), tmp_path)
    headline = re.search(r"<h1>(.*?)</h1>", page)[1]
    assert headline == "The simulator leaves out rotor drag and axial inflow."
    assert page.index("<h1>") < page.index("Perhaps:") < page.index("<strong>blade flapping moment")


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
