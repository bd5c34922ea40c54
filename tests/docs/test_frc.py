"""The page on FRC logs: its platform and its one command, on the log of a concealed drivetrain."""

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import yaml

from simgap.logs.formats import read_log
from simgap.logs.proposal import propose
from simgap.platforms import platform_from_config
from simgap.recordings.recording import read_recording
from tests.contract_checker import read_diagnosis
from tests.pipeline.logs.sysid_routine import TESTS, write_routine
from tests.pipeline.logs.wpilog_encoder import Writer

PAGE = Path(__file__).parents[2] / "docs" / "how_to" / "frc.md"
FRICTION = 25.0  # N


@pytest.mark.slow
def test_one_command_gives_gains_and_names_the_friction(tmp_path: Path) -> None:
    text = PAGE.read_text(encoding="utf-8")
    known = yaml.safe_load(re.search(r"```yaml\n(kind: joint.*?)```", text, re.DOTALL)[1])
    command = re.search(r"^    simgap (diagnose .*)$", text, re.MULTILINE)[1]
    (tmp_path / "my" / "platform").mkdir(parents=True)
    (tmp_path / "my" / "platform" / "drive.yaml").write_text(yaml.safe_dump(known))
    platform = platform_from_config(known)
    write_routine(tmp_path / "drive.wpilog", platform, {"coulomb_friction": {"level": FRICTION}})
    done = subprocess.run(
        [sys.executable, "-m", "simgap", *shlex.split(command), "tracking.enabled=false"],
        cwd=tmp_path,
        env=os.environ | {"OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    answer = tmp_path / "answer"
    runs = read_recording(answer / "clean" / "recording.parquet").split
    assert set(runs) == {f"{test}{round_}" for test in TESTS for round_ in ("", "-2")}
    for test in TESTS:
        assert runs[test] == runs[test.replace("forward", "reverse")]
    document = read_diagnosis(answer / "diagnosis.json", "joint")
    named = [effect for effect in document["effects"] if effect["probability"] >= 0.5]
    assert [effect["name"] for effect in named] == ["coulomb_friction"]
    assert named[0]["parameters"]["level"]["value"] == pytest.approx(FRICTION, rel=0.02)
    gains = next(iter(yaml.safe_load((answer / "sysid" / "parameters.yaml").read_text()).values()))
    constant = platform.motor.torque_constant * platform.motor.gear_ratio
    per_force = platform.motor.resistance / constant
    expected = {"kS": FRICTION * per_force, "kV": constant, "kA": platform.inertia * per_force}
    for name, value in expected.items():
        assert gains[name]["value"] == pytest.approx(value, rel=0.02), name
    assert "feedforward gains of the motor: kS 0.28" in done.stdout
    assert "Identified parameters" in (answer / "report.html").read_text(encoding="utf-8")


def test_the_names_that_a_swerve_drive_is_told_to_log_need_no_mapping(tmp_path: Path) -> None:
    """Each is a column of its module, with its unit."""
    names = re.findall(r'name \+ "(\w+)"', PAGE.read_text(encoding="utf-8"))
    assert len(names) == 5
    log, time = Writer(), 0.02 * np.arange(400)
    for module in range(4):
        for name in names:
            volts = 6.0 * np.sin(time + module)
            log.doubles(f"/Drive/Module{module}/{name}", time, volts * (8.0 if "Velocity" in name else 1.0))
    proposal = propose(read_log(log.write(tmp_path / "drive.wpilog")), None)
    assert proposal.kind == "swerve"
    assert proposal.is_sure
    assert len(proposal.columns) == 20
