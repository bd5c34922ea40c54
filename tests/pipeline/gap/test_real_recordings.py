"""Recordings of real machines, whose answers their authors published."""

import math
from pathlib import Path

import pytest
import yaml

from simgap.api.answer import Answer
from simgap.api.diagnosing import diagnose
from simgap.platforms import platform_from_config
from simgap.recordings.cleaning import clean_recording
from simgap.recordings.importers import importer
from simgap.recordings.recording import Recording
from simgap.recordings.split import Split
from simgap.simulation import Simulator
from tests.pipeline.gap.problems import named, quick, value_of
from tests.pipeline.gap.recordings import ROOT

pytestmark = pytest.mark.slow


# A search through the whole catalogue uses up its budget of 300 s. These are the names that cancel each other, beside
# the thrust coefficient: the whole search finds 0.84 of the platform's, and without it weak rotors stand in for it.
SEARCHED = {
    "pad_normal_E9": [
        "center_of_mass_offset",
        "yaw_trim",
        "rotor_thrust_spread",
        "rotor_fault",
        "thrust_coefficient_error",
        "torque_coefficient_error",
    ]
}


def _platform(name: str):
    return platform_from_config(yaml.safe_load((ROOT / f"conf/platform/{name}.yaml").read_text()))


def _recording(dataset: str, folder: Path, files: list[Path]) -> Recording:
    options = yaml.safe_load((ROOT / f"conf/dataset/{dataset}.yaml").read_text())
    raw = importer(options["importer"])(files, options["options"])
    split = Split(holdout=options["split"]["holdout"])
    return clean_recording(raw, split=split)[0]


def test_rotor_drag_and_inflow_of_a_real_quadrotor(shared_data):
    """Four of the benchmark's flights to fit, one to prove on; the authors' own drag is about 0.45 1/s."""
    folder = shared_data / "nanodrone" / "raw_parquet"
    patterns = ("square_*_run1*", "random*_run1*", "multisine_*_run1*", "melon_*_run1*")
    files = [path for pattern in patterns for path in sorted(folder.glob(pattern))[:2]]
    catalogue = ["rotor_drag", "body_drag", "axial_inflow", "translational_lift", "sensor_time_offset"]
    errors = ["mass_error", "thrust_coefficient_error"]
    found = quick(
        _recording("nanodrone", folder, files),
        Simulator(_platform("crazyflie_brushless")),
        catalogue + errors,
    )
    assert found.verdict == "missing_physics"
    assert {"rotor_drag", "axial_inflow"} <= set(named(found))
    assert 0.40 < value_of(found, "rotor_drag") < 0.50
    before, after, _ = found.validation.channels.T
    assert float(after[0] / before[0]) < 0.30
    assert float(after[1] / before[1]) < 0.45


def test_the_friction_that_a_simulated_robot_was_given(shared_data):
    """The file's authors simulate kS = 0.11114 V; what is found is the same in the motor's volts."""
    folder = shared_data / "swerve_drive_sim"
    platform = _platform("swerve_drivetrain")
    found = quick(
        _recording("swerve_drive_sim", folder, [folder / "data.json"]), Simulator(platform, (), "m")
    )
    assert named(found)[0] == "coulomb_friction"
    motor = platform.motor
    level = value_of(found, "coulomb_friction")
    volts = level * motor.resistance / (motor.torque_constant * motor.gear_ratio)
    assert math.isclose(volts, 0.11114, rel_tol=0.02)


def test_a_servo_loses_a_part_of_the_load_that_its_gear_carries(shared_data):
    """Rhoban/bam find that friction grows with the load; here it holds a raised weight against the whole voltage.

    Their own fit to this servo (bam/params/xl330/m3.json) has a friction of µ = 0.264 times the difference between the
    motor's torque and the outer one. Where the motor slowly raises a weight, that is 2·µ / (1 + µ) of its own: 0.42.
    """
    folder = shared_data / "servo_xl330" / "raw"
    found = quick(
        _recording("servo_xl330", folder, sorted(folder.glob("*.json"))), Simulator(_platform("servo_xl330"))
    )
    believed = [entry.effect.key for entry in found.naming.named if entry.probability >= 0.5]
    assert believed == ["load_dependent_friction"]
    assert value_of(found, "load_dependent_friction") == pytest.approx(0.42, rel=0.15)


def _case(shared_data: Path, name: str) -> tuple[Answer, dict]:
    """Return the answer to a case beside the data, and what is known of it."""
    folder = shared_data.parent / "cases" / "real" / name
    if not folder.is_dir():
        pytest.skip("the real cases are not here: they lie in ../cases beside SIMGAP_DATA")
    (platform,) = (folder / "platform").glob("*.yaml")
    known = yaml.safe_load((folder / "expect.yaml").read_text())
    settings = {"gap": {"effects": SEARCHED.get(name)}}
    return diagnose(folder / "recording.parquet", platform, settings=settings), known


@pytest.mark.parametrize(
    "case",
    [
        "boucwen",
        "damper_30lb",
        "dfki_pendulum",
        "f1tenth_speed",
        "hsm150",
        "lwa4p_joint3",
        "pad_normal_E9",
        "silverbox",
    ],
)
def test_what_a_real_machine_is_known_to_have_is_believed_and_nothing_else(shared_data, case):
    answer, known = _case(shared_data, case)
    assert not known.get("top") or answer.effects[0].name in known["top"]
    believed = {effect.name: effect for effect in answer.effects if effect.probability >= 0.5}
    needed = [{need} if isinstance(need, str) else set(need) for need in known.get("need", [])]
    assert all(names & set(believed) for names in needed)
    assert set(believed) <= set().union(*needed, known.get("top", []), known.get("allow", []))
    for name, (_, value, tolerance) in known.get("value", {}).items():
        first = next(iter(believed[name].parameters.values()))
        assert abs(first.value) == pytest.approx(value, rel=tolerance)
