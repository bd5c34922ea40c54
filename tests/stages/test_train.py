import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pandas as pd
import pytest
import torch
import yaml

from simgap.comparison.comparison import Comparison, Job
from simgap.comparison.table import tables_of
from simgap.errors import InputError
from simgap.models.settings import Training
from simgap.models.storage import load_model
from simgap.platforms import platform_to_config
from simgap.recordings import write_recording
from simgap.runner import StageRun
from simgap.runner.command import main
from simgap.runner.compose import compose, typed
from simgap.stages.train import TrainStage, compared, train
from tests.pipeline.models import learnable
from tests.pipeline.models.rig import COMMANDED, rig
from tests.pipeline.models.synthetic import QUADROTOR

QUICK = Training(max_epochs=2, batch_size=128, horizons=[1, 10], evaluation_windows=100)
ROOT = Path(__file__).parents[2]


def run_stage(tmp_path, recorded, name="linear", settings=QUICK, platform=None):
    path = tmp_path / "recording.parquet"
    write_recording(recorded, path)
    output = tmp_path / "train"
    output.mkdir()
    run = StageRun(output)
    model = {"name": name} | learnable.SMALL[name]
    config = TrainStage(
        recording=str(path),
        platform=platform or {},
        model=model,
        train=settings,
        artifacts=str(tmp_path / "artifacts"),
    )
    train(config, run)
    return run


@pytest.mark.parametrize("name", ["linear", "fnn"])
def test_the_stage_writes_a_model_and_its_errors_on_held_out_runs(name, tmp_path):
    run = run_stage(tmp_path, learnable.linear_joint(), name)
    metrics = json.loads((run.output / "metrics.json").read_text())
    assert set(metrics) == {"position", "velocity", "steps", "validation"}
    assert set(metrics["velocity"]) == {"h1", "h10", "sum"}
    assert set(metrics["steps"]) == {"velocity"}
    assert run.metrics["steps/velocity/mse"] == metrics["steps"]["velocity"]["mse"]
    assert metrics["velocity"]["h1"]["model"] < metrics["velocity"]["h1"]["naive"]
    figure = (run.output / "residuals.svg").read_text()
    assert (">velocity (m/s): " in figure, "uncorrected" in figure) == (True, False)
    model = load_model(run.output / "model")
    assert model.provenance.data == next(iter(run.inputs.values()))
    assert model.provenance.value == run.metrics["validation/loss"]
    assert model.provenance.training["max_epochs"] == 2
    assert not any((tmp_path / "artifacts").rglob("*.ckpt"))


def test_a_hybrid_is_scored_before_compensation_as_well(tmp_path):
    settings = replace(QUICK, steps=3, growth=0.5)
    run = run_stage(tmp_path, learnable.quadrotor(), "hybrid_serial", settings)
    metrics = json.loads((run.output / "metrics.json").read_text())
    before = metrics["uncompensated"]
    assert set(before) == {"position", "attitude", "velocity", "body_rate"}
    assert before["velocity"]["h10"]["naive"] == metrics["velocity"]["h10"]["naive"]
    assert before["velocity"]["h10"]["model"] != metrics["velocity"]["h10"]["model"]


def test_scores_are_compared_with_those_of_persistence_apart():
    errors = {"h1": {"model": 1.0, "naive": 2.0}}
    metrics = {
        "position": errors,
        "steps": {"velocity": {"mse": 3.0, "r_squared": None}},
        "free_run": {"mse": 4.0},
    }
    own = {
        "position/h1": 1.0,
        "steps/velocity/mse": 3.0,
        "steps/velocity/r_squared": None,
        "free_run/mse": 4.0,
    }
    assert compared(metrics) == {"": own, "persistence": {"position/h1": 2.0}}
    assert compared({}) == {"": {}, "persistence": {}}


def test_filters_that_look_ahead_and_quantiles_are_had_for_the_asking(tmp_path):
    plain = json.loads((run_stage(tmp_path, learnable.linear_joint()).output / "metrics.json").read_text())
    asked = replace(QUICK, zero_phase={"velocity": 5.0}, quantiles=[0.5])
    (tmp_path / "asked").mkdir()
    run = run_stage(tmp_path / "asked", learnable.linear_joint(), settings=asked)
    metrics = json.loads((run.output / "metrics.json").read_text())
    assert metrics["velocity"]["h1"] != plain["velocity"]["h1"]
    assert set(metrics["distribution"]["velocity"]["h10"]) == {"q50"}
    assert compared(metrics)[""]["distribution/velocity/h10/q50"] > 0.0
    assert run.metrics["distribution/velocity/h10/q50"] == metrics["distribution"]["velocity"]["h10"]["q50"]
    assert load_model(run.output / "model").provenance.training["zero_phase"] == {"velocity": 5.0}


def test_modules_are_trained_on_together_and_scored_one_by_one(tmp_path):
    settings = replace(QUICK, layout="steering")
    run = run_stage(tmp_path, learnable.swerve(), "linear", settings)
    steps = json.loads((run.output / "metrics.json").read_text())["steps"]
    names = [f"steer_velocity_{number}" for number in range(1, 5)]
    assert set(steps) == {"steer_velocity", *names}
    mean = sum(steps[name]["mse"] for name in names) / 4
    assert steps["steer_velocity"]["mse"] == pytest.approx(mean)
    assert len({steps[name]["mse"] for name in names}) == 4
    groups = json.loads((run.output / "metrics.json").read_text())["step_groups"]
    assert set(groups) == {"steer_velocity"}
    assert groups["steer_velocity"]["mean"]["mse"] == pytest.approx(mean)
    assert run.metrics["step_groups/steer_velocity/variance/mae"] > 0.0
    figure = (run.output / "residuals.svg").read_text()
    assert [figure.count(f">{name} (rad/s): ") for name in ("steer_velocity", *names)] == [1] * 5
    assert load_model(run.output / "model").layout.kind == "steering"
    assert load_model(run.output / "model").provenance.training["layout"] == "steering"


def test_errors_before_and_after_a_correction_are_reported(tmp_path):
    run = run_stage(tmp_path, learnable.linear_joint(), "fnn", replace(QUICK, bias_correction=True))
    scores = json.loads((run.output / "metrics.json").read_text())["steps"]["velocity"]
    model = load_model(run.output / "model")
    assert model.correction is not None
    for name in ("mse", "mae", "r_squared"):
        assert scores[name] != scores[f"{name}_uncorrected"]
    assert ">uncorrected</text>" in (run.output / "residuals.svg").read_text()
    assert run.metrics["steps/velocity/mse_uncorrected"] == scores["mse_uncorrected"]


def test_the_tables_of_motors_are_found_in_the_metrics(tmp_path):
    settings = replace(QUICK, layout="swerve_chassis", bias_correction=True)
    run = run_stage(tmp_path, learnable.swerve(), settings=settings)
    own = compared(json.loads((run.output / "metrics.json").read_text()))[""]
    wanted = typed(TrainStage, compose(["+experiment=swerve_motors"])).results
    tables = tables_of(Comparison("motors", "", "", [Job({"model": "linear"}, 0, own)], results=wanted))
    assert [table.title for table in tables] == [table.title for table in wanted.tables]
    titles = [table.title for table in tables]
    after = tables[titles.index("drive motors, mean squared error (rad/s)²")]
    before = tables[titles.index("before the bias correction, mean squared error (rad/s)²")]
    assert after.columns == [*(f"drive_velocity_{number}" for number in range(1, 5)), "variance", "mean"]
    kinds = ("drive_velocity", "steer_velocity")
    assert before.columns == [f"{kind}/{over}" for kind in kinds for over in ("mean", "variance")]
    motors = [own[f"steps/drive_velocity_{number}/mse_uncorrected"] for number in range(1, 5)]
    assert before.rows[0].entries["drive_velocity/mean"].mean == pytest.approx(sum(motors) / 4)


def test_free_runs_and_residual_ratios_are_written_where_they_are_asked_for(tmp_path):
    settings = replace(
        QUICK, free_run=1.0, residual_ratios=True, moving_window=2.0, noise=0.1, share=0.5, shift=0.5
    )
    run = run_stage(tmp_path, learnable.linear_joint(), settings=settings)
    metrics = json.loads((run.output / "metrics.json").read_text())
    scored = {"position", "velocity", "steps", "free_run", "residual_ratios", "moving_window"}
    assert set(metrics) == scored | {"validation"}
    assert set(metrics["moving_window"]["velocity"]) == {"P_f", "P_i"}
    assert set(metrics["free_run"]["velocity"]) == {"mse", "correlation"}
    assert set(metrics["residual_ratios"]["velocity"]) == {"P_f", "P_i"}
    assert run.metrics["free_run/velocity/mse"] == metrics["free_run"]["velocity"]["mse"]
    assert (run.output / "free_run.svg").read_text().startswith("<svg")
    assert set(pd.read_parquet(run.output / "free_run.parquet")["state"]) == {"position", "velocity"}


def test_free_runs_are_scored_in_windows_that_move_along_the_held_out_time(tmp_path):
    def scores(windows):
        folder = tmp_path / str(windows)
        folder.mkdir()
        settings = replace(QUICK, free_run=1.0, test_windows=windows)
        run = run_stage(folder, learnable.linear_joint(), settings=settings)
        metrics = json.loads((run.output / "metrics.json").read_text())
        return metrics["free_run"], metrics.get("test_windows", {})

    whole, single = scores(1)
    assert single == {"1": whole}
    _, parts = scores(2)
    assert set(parts) == {"1", "2"}
    assert parts["1"]["velocity"] != parts["2"]["velocity"]
    assert scores(0)[1] == {}


def test_gain_time_constant_and_damping_stand_in_the_metrics(tmp_path):
    settings = replace(QUICK, layout="attitude", horizons=[1])
    run = run_stage(tmp_path, rig(), "transfer_function", settings)
    found = json.loads((run.output / "metrics.json").read_text())["parameters"]
    for axis, true in zip("xyz", COMMANDED, strict=True):
        expected = {"K": true.gain, "T": true.time_constant, "ζ": true.damping}
        assert found[f"body_rate_{axis}"] == pytest.approx(expected, rel=1e-3)


def test_motor_commands_are_learned_through_their_layout(tmp_path):
    settings = replace(QUICK, layout="motor_command", horizons=[1])
    run = run_stage(tmp_path, rig(), "rbf", settings, platform_to_config(QUADROTOR))
    layout = load_model(run.output / "model").layout
    assert layout.kind == "motor_command"
    assert layout.rotor_y == tuple(place[1] for place in QUADROTOR.rotor_positions)


def test_without_a_validation_run_the_end_of_the_training_runs_validates(tmp_path):
    recorded = learnable.linear_joint()
    split = {run: "holdout" if run == "d" else "train" for run in recorded.runs}
    run = run_stage(tmp_path, replace(recorded, split=split))
    assert run.warnings == ["no validation run: the last 20% of each training segment validates"]


def test_one_run_alone_cannot_be_trained_on(tmp_path):
    recorded = learnable.linear_joint()
    alone = replace(recorded, frame=recorded.frame[recorded.frame["run"] == "a"], split={"a": "train"})
    with pytest.raises(InputError, match="no run can be held out; record a second run"):
        run_stage(tmp_path, alone)


def test_where_training_is_disabled_nothing_is_read_and_the_metrics_are_empty(tmp_path, caplog):
    caplog.set_level("INFO", "simgap")
    run = StageRun(tmp_path)
    train(TrainStage(recording="absent.parquet", train=Training(enabled=False)), run)
    assert caplog.messages == ["train: nothing is trained, because train.enabled is false"]
    assert [path.name for path in run.output.iterdir()] == ["metrics.json"]
    assert json.loads((run.output / "metrics.json").read_text()) == {}
    assert run.inputs == run.metrics == {}


def test_the_branch_of_one_run_trains_nothing_and_succeeds(tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        main(train, ["branch=flywheel", f"artifacts={tmp_path}", "tracking.enabled=false"])
    assert ended.value.code == 0
    assert "nothing is trained" in "".join(capsys.readouterr())
    assert [path.name for path in (tmp_path / "train").iterdir()] == ["metrics.json"]


def test_a_recording_that_is_not_cleaned_is_refused(tmp_path):
    with pytest.raises(InputError, match="clean it first"):
        run_stage(tmp_path, replace(learnable.linear_joint(), cleaned=False))


@pytest.mark.parametrize("horizons", [[0], [100_000]])
def test_impossible_horizons_are_refused(horizons, tmp_path):
    with pytest.raises(InputError, match=r"train\.horizons"):
        run_stage(tmp_path, learnable.linear_joint(), settings=replace(QUICK, horizons=horizons))


def test_a_sweep_keeps_the_outputs_of_its_jobs_apart(tmp_path):
    trained(tmp_path, "-m", "model=linear", "model.sequence_length=1,3")
    written = sorted((tmp_path / "artifacts").rglob("model.yaml"))
    assert [yaml.safe_load(path.read_text())["model"]["sequence_length"] for path in written] == [1, 3]
    (table,) = (tmp_path / "artifacts").rglob("comparison.md")
    assert {"| 1 | ", "| 3 | ", "| persistence | "} <= set(
        re.findall(r"(?m)^\| [\w.]+ \| ", table.read_text())
    )


def test_both_cores_give_the_numbers_of_one(tmp_path, monkeypatch):
    small = ("-m", "model=fnn,tcn", "model.hidden=[8]", "model.dropout=[0.1]", "train.max_epochs=2")
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)  # a job takes one thread by itself
    parallel = [*arguments(tmp_path, *small, "hydra/launcher=joblib"), f"output={tmp_path / 'parallel'}"]
    subprocess.run(parallel, cwd=ROOT, check=True, capture_output=True)
    torch.set_num_threads(2)
    trained(tmp_path, *small, f"output={tmp_path / 'serial'}")
    files = [
        path.relative_to(tmp_path / "serial") for path in (tmp_path / "serial").rglob("model.safetensors")
    ]
    assert len(files) == 2
    for file in [*files, *(file.parents[1] / "metrics.json" for file in files)]:
        assert (tmp_path / "serial" / file).read_bytes() == (tmp_path / "parallel" / file).read_bytes()


def test_a_killed_training_ends_like_an_undisturbed_one(tmp_path):
    settings = (
        "model=fnn",
        "model.hidden=[8]",
        "train.max_epochs=60",
        "train.patience=60",
        "train.batch_size=64",
    )
    process = subprocess.Popen(arguments(tmp_path, *settings, "output=" + str(tmp_path / "killed")), cwd=ROOT)
    while process.poll() is None and not any((tmp_path / "artifacts").rglob("last.ckpt")):
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not (tmp_path / "killed").exists()
    assert any((tmp_path / "artifacts").rglob("last.ckpt"))
    trained(tmp_path, *settings, "output=" + str(tmp_path / "killed"))
    trained(tmp_path, *settings, "output=" + str(tmp_path / "whole"))
    files = ("metrics.json", "model/model.yaml", "model/model.safetensors")
    for file in files:
        assert (tmp_path / "killed" / file).read_bytes() == (tmp_path / "whole" / file).read_bytes()


def arguments(tmp_path, *overrides):
    path = tmp_path / "recording.parquet"
    if not path.exists():
        write_recording(learnable.linear_joint(), path)
    own = [f"recording={path}", f"artifacts={tmp_path / 'artifacts'}", "tracking.enabled=false"]
    flags = [text for text in overrides if text.startswith("-")]
    rest = [text for text in overrides if not text.startswith("-")]
    return [sys.executable, "-m", "simgap.stages.train", *flags, "branch=swerve_drive", *own, *rest]


def trained(tmp_path, *overrides):
    """Run the command in this process, which has paid for its imports."""
    with pytest.raises(SystemExit) as ended:
        main(train, arguments(tmp_path, *overrides)[3:])
    assert ended.value.code == 0
