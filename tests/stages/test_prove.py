"""The benchmark from end to end, small: two joints, of which one conceals nothing."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from simgap.errors import InputError
from simgap.runner import StageRun
from simgap.runner.command import run_command
from simgap.runner.compose import compose, typed
from simgap.stages._benchmark_case import Concealed, examine
from simgap.stages._prove_settings import ProveStage
from simgap.stages._strengths import energy_over_noise, settled
from simgap.stages.calibrate import calibrate
from simgap.stages.prove import prove
from simgap.stages.record import draw_cases

JOINT = {
    "machines": {"servo": {}},
    "effects": {"coulomb_friction": {}},
    "conditions": {"runs": 4, "duration": 4.0, "rate": 100.0},
}


def configured(config_class: type[Any], folder: Path) -> Any:
    values = compose(["seed=3", "gap.effects=[coulomb_friction, viscous_friction]"])
    small = {"kinds": ["joint"], "cases": 2, "joint": JOINT, "shares": {"clear": 1.0, "nothing": 1.0}}
    values["prove"] |= small | {"folder": str(folder / "cases")}
    return typed(config_class, values | {"artifacts": str(folder)})


@pytest.fixture(scope="module")
def proved(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("prove")
    output = folder / "out"
    output.mkdir()
    prove(configured(ProveStage, folder), StageRun(output))
    return folder


def test_what_is_concealed_is_recorded_sealed_diagnosed_and_scored(proved: Path) -> None:
    results = json.loads((proved / "out" / "results.json").read_text())
    scores = {result["case"]["subject"]["category"]: result["score"] for result in results}
    assert scores["clear"]["concealed"] == ["coulomb_friction"]
    assert scores["clear"]["outcome"] == "right"
    assert scores["clear"]["errors"]["coulomb_friction"]["level"] < 0.1
    assert (scores["nothing"]["concealed"], scores["nothing"]["outcome"]) == ([], "right")
    assert all(result["seconds"] > 0 for result in results)
    assert "| clear effects named first: 100%" in (proved / "out" / "proof.md").read_text()


def test_the_key_is_nowhere_near_the_diagnosis(proved: Path) -> None:
    kept = [path for path in (proved / "cases").rglob("*") if path.is_file()]
    assert {path.name for path in kept} == {"log.txt", "result.json"}
    assert len(list((proved / "cases_keys").glob("*.json"))) == 2


def test_a_finished_benchmark_is_not_run_again_and_a_changed_key_is_refused(proved: Path) -> None:
    config = configured(ProveStage, proved)
    before = {path: path.stat().st_mtime_ns for path in (proved / "cases").rglob("result.json")}
    again = proved / "again"
    again.mkdir()
    prove(config, StageRun(again))
    assert {path: path.stat().st_mtime_ns for path in before} == before
    for key in (proved / "cases_keys").glob("*.json"):
        key.write_text(key.read_text().replace("coulomb", "viscous") + " ")
    with pytest.raises(InputError, match="not the key that the recording was sealed with"):
        prove(config, StageRun(again))


def test_a_case_that_cannot_be_recorded_is_reported(tmp_path: Path) -> None:
    config = configured(ProveStage, tmp_path)
    machines = {"servo": compose(["platform=servo"])["platform"]}
    (case,) = draw_cases("joint", config.prove.joint, {"nothing": 1.0}, machines, 1, 1)
    broken = replace(case, record=case.record | {"runs": -1})
    answer = examine(Concealed(broken, config, tmp_path / "key.json"), tmp_path / "case")
    assert answer["failed"].startswith("InputError: record.runs: must be positive")
    assert "source" not in answer


def test_calibration_seeds_do_not_make_a_page(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    overrides = ["seed=10001", "prove.write_docs=true", "prove.kinds=[]", f"output={tmp_path / 'out'}"]
    assert run_command(prove, [*overrides, "tracking.enabled=false"]) == 2
    assert "10001 is a seed for calibration" in capfd.readouterr().err


def test_calibration_without_results_is_refused(capfd: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    assert run_command(calibrate, ["tracking.enabled=false", f"output={tmp_path / 'out'}"]) == 2
    assert "prove.results: no results are given" in capfd.readouterr().err


def drawn(config: ProveStage, kind: str, machine: str, **shares: float) -> Any:
    machines = {machine: compose([f"platform={machine}"])["platform"]}
    (case,) = draw_cases(kind, getattr(config.prove, kind), shares, machines, 3, 1)
    return case


def test_a_faint_case_is_as_strong_as_the_noise_and_nothing_else_of_it_changes(tmp_path: Path) -> None:
    config = configured(ProveStage, tmp_path)
    usual = drawn(config, "joint", "servo", faint=1.0)
    case, energies = settled(usual, config)
    assert 0.5 <= energies["coulomb_friction"] <= 2.0
    assert energies["coulomb_friction"] == energy_over_noise(case, "coulomb_friction", config)
    assert (
        case.record["effects"]["coulomb_friction"]["level"]
        < 0.5 * (usual.record["effects"]["coulomb_friction"]["level"])
    )
    assert replace(case, record={}) == replace(usual, record={})


def usual_case(
    folder: Path, kind: str, machine: str, effect: str, category: str = "clear"
) -> tuple[Any, ProveStage]:
    """Return a short case of an effect of usual size on a machine, and the configuration that it is drawn with."""
    config = configured(ProveStage, folder)
    table = {
        "machines": {machine: {}},
        "effects": {effect: {}},
        "conditions": {"runs": 2, "duration": 4.0, "rate": 100.0},
    }
    setattr(config.prove, kind, table)
    return drawn(config, kind, machine, **{category: 1.0}), config


def test_a_delay_that_samples_cannot_tell_shows_nothing(tmp_path: Path) -> None:
    case, config = usual_case(tmp_path, "joint", "servo", "command_delay")
    assert energy_over_noise(case, "command_delay", config) > 10.0
    assert energy_over_noise(case.scaled("command_delay", 0.05), "command_delay", config) == 0.0


def test_a_number_that_is_off_by_less_than_a_fit_can_tell_shows_nothing(tmp_path: Path) -> None:
    case, config = usual_case(tmp_path, "joint", "servo", "motor_constant_error", "decoy")
    assert energy_over_noise(case, "motor_constant_error", config) > 10.0
    assert energy_over_noise(case.scaled("motor_constant_error", 0.01), "motor_constant_error", config) == 0.0


def test_which_rotor_is_damaged_is_known_to_what_settles_the_strength(tmp_path: Path) -> None:
    """One concealed name stands for four effects of the catalogue, one for each rotor."""
    case, config = usual_case(tmp_path, "quadrotor", "racer", "rotor_fault")
    assert energy_over_noise(case, "rotor_fault", config) > 1000
