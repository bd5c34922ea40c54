"""An answer: its values, how it is shown and what it writes."""

import dataclasses
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import torch
import yaml

from simgap.api.answer import Answer
from simgap.api.diagnosing import diagnose
from simgap.api.display import html, text
from simgap.api.findings import Effect, Size, Unnamed, built
from simgap.api.inputs import platform_config
from simgap.api.simulators import load_simulator
from simgap.errors import InputError
from simgap.recordings.recording import Recording, write_recording
from tests.contract_checker import read_diagnosis
from tests.pipeline.gap.recordings import JOINT, Plant, joint_recording

SETTINGS = {
    "gap": {
        "effects": ["coulomb_friction", "viscous_friction"],
        "resamples": 50,
        "horizon": 0.05,
    }  # to be quick
}


def raw(runs: int = 6) -> Recording:
    clean = joint_recording(Plant(friction=0.3), runs=runs)
    return Recording(clean.frame, "joint", clean.units, source="a bench")


@pytest.fixture(scope="module")
def answer() -> Answer:
    before = torch.get_num_threads()
    found = diagnose(raw().frame, JOINT, settings=SETTINGS)
    assert torch.get_num_threads() == before
    return found


@pytest.fixture(scope="module")
def saved(answer: Answer, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return answer.save(tmp_path_factory.mktemp("saved") / "answer")


def test_the_friction_is_found(answer):
    (effect,) = answer.effects
    assert answer.verdict == "missing_physics"
    assert effect.name == "coulomb_friction"
    assert effect.probability > 0.5
    level = effect.parameters["level"]
    assert level.value == pytest.approx(0.3, rel=0.02)
    assert 0.0 < level.std < 0.01
    assert level.unit == "N·m"
    assert answer.fit.gap_closed is not None
    assert answer.fit.gap_closed > 0.9


def test_an_answer_holds_what_the_file_holds(answer, saved):
    document = {"contradictions": [], **read_diagnosis(saved / "diagnosis.json", "joint")}
    held = {
        entry.name: getattr(answer, entry.name)
        for entry in dataclasses.fields(answer)
        if not entry.name.startswith("_")
    }
    assert held.keys() == document.keys() - {"schema"}
    plain = json.loads(json.dumps({name: _plain(value) for name, value in held.items()}))
    assert {"schema": "simgap.diagnosis/1", **plain} == document


def _plain(value: object) -> object:
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        plain = dataclasses.asdict(value)
        whole = isinstance(value, Effect) and not value.runs  # the file lists runs where these are not all
        return {name: entry for name, entry in plain.items() if not (whole and name == "runs")}
    return [_plain(entry) for entry in value] if isinstance(value, tuple) else value


def test_what_is_saved_is_what_the_command_writes(answer, saved):
    assert {path.name for path in saved.iterdir()} == {
        *(".simgap", "clean", "diagnosis.json", "evidence", "report.html", "simulator", "sysid"),
    }
    assert [path for path in saved.parent.iterdir() if path != saved] == []


def test_the_simulator_is_the_one_that_is_saved(answer, saved):
    start, volts = answer.simulator.state(velocity=2.0), np.zeros((50, 1))
    rolled = answer.simulator.rollout(start, volts, 0.005, substeps=4)
    np.testing.assert_allclose(load_simulator(saved).rollout(start, volts, 0.005, substeps=4), rolled)
    nominal = answer.nominal.rollout(start, volts, 0.005, substeps=4)
    assert answer.nominal.effects == ()
    assert rolled[-1, 1] < nominal[-1, 1] - 0.1


@pytest.mark.slow
def test_the_same_table_gives_the_same_answer(answer, tmp_path):
    frame = raw().frame
    columns = {str(name): frame[name].to_numpy() for name in frame}
    assert diagnose(columns, platform_config(JOINT), settings=SETTINGS) == answer


def test_the_page_is_written_alone(answer, saved, tmp_path):
    page = answer.report(str(tmp_path / "page.html"))
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]
    for path in (page, saved / "report.html"):
        assert path.read_text(encoding="utf-8").startswith("<!")
        assert "coulomb friction" in path.read_text(encoding="utf-8").lower()


def test_a_place_that_cannot_be_written_is_refused(answer, tmp_path):
    with pytest.raises(InputError, match=r"page\.html: cannot be written"):
        answer.report(tmp_path / "nowhere" / "page.html")
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(InputError, match="is a file where a directory is to be written"):
        answer.save(tmp_path / "file")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_an_answer_does_not_change(answer):
    with pytest.raises(dataclasses.FrozenInstanceError):
        answer.verdict = "none"


def test_an_answer_is_read_at_a_glance(answer):
    lines = repr(answer).splitlines()
    assert lines[:2] == ["verdict: missing_physics", "The simulator leaves out Coulomb friction."]
    assert "N·m" in lines[2]
    assert "of the gap on runs never used for fitting" in repr(answer)
    assert "<b>The simulator leaves out Coulomb friction.</b>" in answer._repr_html_()
    assert "<td" in answer._repr_html_()


def test_what_is_shown_is_escaped_and_doubts_are_said(answer):
    evil = "<script>alert(1)</script>"
    (found,) = answer.document["effects"]
    values = {"level": {"value": 1.0, "std": 0.1, "unit": evil}}
    shown = answer.document | {
        "effects": [found | {"name": evil, "probability": 0.3, "parameters": values, "statement": evil}],
        "ambiguous": [{"names": [evil, "other"], "separate_by": evil}],
        "unnamed": [{"channel": evil, "depends_on": [evil], "formula": evil, "share": 0.5}],
        "warnings": [evil],
        "fit": answer.document["fit"] | {"gap_closed": None, "held_out_runs": []},
    }
    assert "<script" not in html(shown)
    assert "perhaps &lt;script" in html(shown)
    assert "no run could be held out" in text(shown)
    assert text(shown).splitlines()[-1] == "warnings: 1"


def test_plain_values_become_the_types_that_are_written_down():
    plain = {"channel": "torque", "depends_on": ["t"], "formula": "0.2 t", "share": 0.1}
    size = {"value": 0.2, "noise": 0.1, "unit": "N·m"}
    assert built(Unnamed, plain) == Unnamed("torque", ("t",), "0.2 t", 0.1)
    assert built(Unnamed, {**plain, "size": size}).size == Size(0.2, 0.1, "N·m")


def test_an_effect_lists_the_runs_in_which_it_acts():
    plain = {
        "name": "rotor_fault",
        "probability": 0.9,
        "acts_on": "actuator",
        "parameters": {},
        "statement": "",
    }
    assert built(Effect, plain).runs == ()
    runs = [{"run": "b", "from": 2.0}, "c"]
    assert built(Effect, {**plain, "runs": runs}).runs == tuple(runs)


def test_a_recording_of_another_kind_is_refused():
    with pytest.raises(InputError, match="is of a joint, the platform is a quadrotor"):
        diagnose(raw(1), "racer")
    with pytest.raises(InputError, match="platform: key 'inertia' is missing"):
        diagnose(raw(1), {"gravity_torque": 1.0})


@pytest.mark.slow
def test_it_writes_nothing_and_needs_no_tracking(answer, tmp_path):
    write_recording(raw(), tmp_path / "bench.parquet")
    (tmp_path / "axis.yaml").write_text(yaml.safe_dump(platform_config(JOINT)))
    program = (
        "import sys, simgap\n"
        f"answer = simgap.diagnose('bench.parquet', platform='axis.yaml', settings={SETTINGS})\n"
        "assert not {'mlflow', 'dvc', 'gymnasium', 'matplotlib'} & set(sys.modules)\n"
        "print(answer)\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{answer}\n"
    assert done.stderr == ""
    assert sorted(path.name for path in tmp_path.iterdir()) == ["axis.yaml", "bench.parquet"]
