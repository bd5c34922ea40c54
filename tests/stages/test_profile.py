import json
from dataclasses import replace

import pytest
import yaml

from simgap.errors import InputError
from simgap.policies.profile import contenders
from simgap.policies.profile.settings import Profile
from simgap.policies.profile.storage import FILE, read_motions
from simgap.policies.settings import Deployment, Learning
from simgap.policies.storage import load_policy
from simgap.runner import StageRun
from simgap.runner.command import main
from simgap.runner.compose import compose
from simgap.stages.deploy import DeployStage, deploy
from simgap.stages.profile import ProfileStage, compared, profile

PRESET = compose(["+experiment=motion_profile"])
FEW = Learning(interactions=4000, machines=16, horizon=32, minibatch=256, hidden=[8])
TASK = Profile(learning=FEW, episode=2.0)
GAINS = {"kS": {"value": 0.41}, "kV": {"value": 0.01423}, "kA": {"value": 0.00372}}
FOUND = {f"drive_{n}": GAINS for n in range(1, 5)} | {"wheels": {"rolling_radius": {"value": 0.02925}}}


def branch(folder):
    """Write what sysid would have written of the concealed shuttle."""
    (folder / "sysid").mkdir(parents=True)
    (folder / "sysid" / "parameters.yaml").write_text(yaml.safe_dump(FOUND))
    return folder


def run_profile(folder, **options):
    output = folder / "profile"
    output.mkdir()
    run = StageRun(output)
    given = {"artifacts": str(folder), "platform": PRESET["platform"], "profile": TASK} | options
    profile(ProfileStage(**given), run)
    return run


def run_deploy(folder, name="deploy", **options):
    output = folder / name
    output.mkdir()
    run = StageRun(output)
    given = {
        "artifacts": str(folder),
        "platform": PRESET["platform"],
        "record": PRESET["record"],
        "profile": TASK,
    }
    deploy(DeployStage(**given, deploy=Deployment(**options)), run)
    return run


@pytest.fixture(scope="module")
def planned(tmp_path_factory):
    folder = branch(tmp_path_factory.mktemp("branch"))
    return folder, run_profile(folder)


def test_it_writes_all_motions_their_picture_and_the_policy(planned):
    folder, run = planned
    motions = read_motions(run.output / FILE)
    assert set(motions) == {
        contenders.PUBLISHED,
        contenders.TRAPEZOID,
        contenders.S_CURVE,
        contenders.POLICY,
        contenders.BOUND,
        contenders.VOLTAGE_BOUND,
    }
    assert (run.output / "motions.svg").read_text().startswith("<?xml")
    _, description = load_policy(run.output / "policy")
    assert (description.task, description.period) == ("motion_profile", TASK.period)
    assert not list((folder / "checkpoints").glob("*"))


def test_the_sequence_of_the_fastest_policies_is_drawn(tmp_path):
    near = replace(TASK, tolerance=2.9, speed_tolerance=5.0)  # every policy that moves arrives
    run = run_profile(branch(tmp_path / "near"), profile=near)
    assert " s</text>" in (run.output / "policy_improvements.svg").read_text()


def test_a_policy_that_does_not_arrive_is_said_and_the_others_are_compared(planned):
    _, run = planned
    assert run.warnings == ["the policy does not arrive: train it longer, or widen profile.narrow"]
    assert run.metrics[f"{contenders.BOUND}/over_bound"] == 0.0
    assert run.metrics[f"{contenders.PUBLISHED}/faster"] == 0.0
    assert run.metrics[f"{contenders.TRAPEZOID}/faster"] > 0.1
    assert run.metrics[f"{contenders.S_CURVE}/over_bound"] > 0.1


def test_a_sweep_holds_the_policy_against_the_others(planned):
    _, run = planned
    tables = compared(run.metrics)
    assert set(tables[""]) == set(tables[contenders.BOUND]) == set(tables[contenders.PUBLISHED])
    assert not any("training" in name for name in tables)


def test_twin_runs_write_the_same(planned, tmp_path):
    _, first = planned
    second = run_profile(branch(tmp_path / "twin"))
    for file in (FILE, "motions.svg", "policy/policy.safetensors"):
        assert (first.output / file).read_bytes() == (second.output / file).read_bytes()


def test_another_platform_than_a_swerve_drive_is_refused(tmp_path):
    with pytest.raises(InputError, match="swerve"):
        run_profile(branch(tmp_path / "other"), platform=compose(["platform=pendulum"])["platform"])


def test_what_was_planned_comes_to_rest_at_the_target_on_the_concealed_plant(planned):
    folder, _ = planned
    run = run_deploy(folder, motion=contenders.S_CURVE, window=1)
    assert run.metrics["trials/inside"] == run.metrics["trials/number"] == 5
    assert run.metrics["trials/worst_miss"] < 0.03
    assert 0.0 < run.metrics["trials/spread_miss"] < run.metrics["trials/worst_miss"]
    assert 0.0 < run.metrics["trials/spread_time"] < 0.1
    assert run.metrics["trials/time"] == pytest.approx(run.metrics["foreseen/time"], abs=0.1)
    assert (run.output / "trials.svg").exists()
    assert (run.output / "trials.parquet").exists()


def test_an_unknown_motion_is_named_with_the_nearest(planned):
    folder, _ = planned
    with pytest.raises(InputError, match="did you mean 'fastest_s_curve'"):
        run_deploy(folder, "typo", motion="fastest_scurve")


def test_the_metrics_file_has_null_where_there_is_no_number(planned):
    _, run = planned
    run.write_metrics()
    written = json.loads((run.output / "metrics.json").read_text())
    assert written[f"{contenders.POLICY}/time"] is None


def test_a_mistake_on_the_command_line_is_one_line(planned, capsys):
    folder, _ = planned
    command = ["+experiment=motion_profile", f"artifacts={folder}", f"output={folder / 'typed'}"]
    with pytest.raises(SystemExit) as ended:
        main(deploy, [*command, "deploy.motion=bang_bang"])
    assert ended.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "there is no motion 'bang_bang'" in line
    assert not (folder / "typed").exists()


def test_the_command_line_drives_what_was_planned(planned, capsys):
    folder, _ = planned
    command = ["+experiment=motion_profile", f"artifacts={folder}", f"output={folder / 'driven'}"]
    with pytest.raises(SystemExit) as ended:
        main(deploy, [*command, f"deploy.plan={folder / 'profile'}", "deploy.motion=fastest_s_curve"])
    assert ended.value.code == 0
    assert json.loads((folder / "driven" / "metrics.json").read_text())["trials/inside"] == 5
