import json
from dataclasses import replace

import pytest
import yaml

from simgap.errors import InputError
from simgap.models.settings import SystemIdentification
from simgap.recordings import write_recording
from simgap.runner import StageRun
from simgap.stages.sysid import SysidStage, sysid
from tests.pipeline.models.synthetic import MOTOR, characterisation

PLATFORM = {"kind": "joint", "inertia": 27.0}


def run_stage(tmp_path, recorded, name="sysid", **options):
    path = tmp_path / "recording.parquet"
    write_recording(recorded, path)
    output = tmp_path / name
    output.mkdir()
    run = StageRun(output)
    sysid(SysidStage(recording=str(path), **({"platform": PLATFORM} | options)), run)
    return run


def test_the_stage_writes_parameters_that_a_person_can_read(tmp_path):
    run = run_stage(tmp_path, characterisation(0))
    parameters = yaml.safe_load((run.output / "parameters.yaml").read_text())
    assert list(parameters["motor"]) == ["kS", "kV", "kA"]
    assert parameters["motor"]["kV"]["unit"] == "V/(m/s)"
    assert parameters["motor"]["kV"]["value"] == pytest.approx(MOTOR["kV"], rel=0.01)
    assert parameters["motor"]["kV"]["standard_error"] > 0
    metrics = json.loads((run.output / "metrics.json").read_text())
    assert set(metrics["motor"]) == {"mse", "mae", "r2", "samples"}
    assert run.metrics["motor/r2"] == metrics["motor"]["r2"]


def test_nothing_is_learned_from_held_out_runs(tmp_path):
    recorded = characterisation(0)
    split = {run: "holdout" if run.startswith("slow") else "train" for run in recorded.runs}
    held = replace(recorded, split=split)
    frame = held.frame.copy()
    frame.loc[frame["run"].str.startswith("slow"), "voltage"] *= 3.0
    first = run_stage(tmp_path, held, "first").output
    second = run_stage(tmp_path, replace(held, frame=frame), "second").output
    for file in ("parameters.yaml", "metrics.json"):
        assert (first / file).read_bytes() == (second / file).read_bytes()


def test_motors_are_reported_by_name(tmp_path):
    settings = SystemIdentification(motors={"forth": ["*-f"], "back": ["*-b"]})
    run = run_stage(tmp_path, characterisation(0), sysid=settings)
    assert list(yaml.safe_load((run.output / "parameters.yaml").read_text())) == ["forth", "back"]


def test_a_joint_without_voltage_has_no_motor_and_says_so(tmp_path):
    recorded = characterisation(0)
    frame = recorded.frame.rename(columns={"voltage": "effort"})
    units = {"position": "m", "velocity": "m/s", "effort": "N"}
    run = run_stage(tmp_path, replace(recorded, frame=frame, units=units))
    assert run.warnings == ["no voltage was recorded: there is no motor to identify"]
    assert yaml.safe_load((run.output / "parameters.yaml").read_text()) == {}


def test_a_recording_of_another_kind_is_refused(tmp_path):
    quadrotor = {
        "kind": "quadrotor",
        "mass": 1.0,
        "inertia": [1.0, 1.0, 1.0],
        "rotor_positions": [[1, -1, 0], [-1, -1, 0], [-1, 1, 0], [1, 1, 0]],
        "rotor_directions": [-1, 1, -1, 1],
        "thrust_coefficient": 1e-6,
        "torque_coefficient": 1e-8,
        "motor_speed_max": 1000.0,
        "nominal_voltage": 10.0,
    }
    with pytest.raises(InputError, match="is of a joint, the platform is a quadrotor"):
        run_stage(tmp_path, characterisation(0), platform=quadrotor)
