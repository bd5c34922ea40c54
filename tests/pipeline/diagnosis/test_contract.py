import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.diagnosis.contract import ambiguous, diagnosis_document, write_json
from simgap.diagnosis.evidence import write_evidence
from simgap.effects import effect_by_key
from simgap.gap.name import Rivalry
from simgap.simulation import FittedEffect, Simulator, read_simulator, write_simulator
from tests.contract_checker import check_diagnosis, read_diagnosis
from tests.pipeline.gap.problems import FEW, diagnosed, quick
from tests.pipeline.gap.recordings import (
    JOINT,
    Plant,
    joint_recording,
    joint_simulator,
    racer,
    uneventful_flights,
)

pytestmark = pytest.mark.slow


def _documents(plant, runs=6):
    late = ("sensor_time_offset",) if plant.delay else ()  # then two names are ambiguous
    return diagnosis_document(diagnosed(plant, runs=runs, effects=(*FEW, *late)))


@pytest.mark.parametrize(
    ("plant", "verdict"),
    [
        (Plant(), "none"),
        (Plant(friction=0.3, delay=0.02), "missing_physics"),
        (Plant(inertia=1.3), "parameter_mismatch"),
        (Plant(other=lambda q, v: 0.05 * np.sin(3.0 * q) * v), "unexplained"),
        (Plant(inertia=1.3, other=lambda q, v: 0.05 * np.sin(3.0 * q) * v), "unexplained"),
    ],
    ids=["none", "missing_physics", "parameter_mismatch", "unexplained", "unexplained_beside_a_number"],
)
def test_every_verdict_is_written_as_the_contract_says(plant, verdict, tmp_path):
    document = _documents(plant)
    assert document["verdict"] == verdict
    write_json(document, tmp_path / "diagnosis.json")
    assert read_diagnosis(tmp_path / "diagnosis.json", "joint") == json.loads(json.dumps(document))


def test_a_quadrotor_is_written_as_the_contract_says():
    simulator = Simulator(replace(racer(), mass=racer().mass / 1.15))
    few = ["rotor_drag", "motor_lag", "mass_error", "thrust_coefficient_error"]
    document = diagnosis_document(quick(uneventful_flights()[0], simulator, few))
    assert [effect["name"] for effect in document["effects"]] == ["mass_error"]
    check_diagnosis(document, "quadrotor")


def test_rivals_come_with_their_subjects():
    def swerve(key):
        return effect_by_key("swerve", key)

    rivalry = Rivalry(swerve("backlash@steer"), (swerve("module_misalignment@chassis"),))
    offsets = {f"offset_{module}": 0.3 * (module == 2) for module in range(1, 5)}
    known = {"module_misalignment@chassis": FittedEffect(swerve("module_misalignment@chassis"), offsets)}
    for fitted, module in ((known, "2"), ({}, None)):
        entry = ambiguous(rivalry, fitted)
        assert entry["names"] == ["backlash", "module_misalignment"]
        assert entry["subjects"] == ["steer", module]


def test_units_follow_the_axis_and_places_are_the_contracts():
    document = _documents(Plant(friction=0.3, delay=0.02))
    entries = {effect["name"]: effect for effect in document["effects"]}
    assert entries["coulomb_friction"]["parameters"]["level"]["unit"] == "N·m"
    assert entries["coulomb_friction"]["acts_on"] == "torque"
    assert entries["command_delay"]["acts_on"] == "command"
    assert entries["command_delay"]["parameters"]["delay"]["unit"] == "s"
    sliding = replace(
        joint_recording(Plant(friction=0.3)), units={"position": "m", "velocity": "m/s", "voltage": "V"}
    )
    (effect,) = diagnosis_document(quick(sliding, Simulator(JOINT, position_unit="m"), FEW))["effects"]
    assert effect["acts_on"] == "force"
    assert effect["parameters"]["level"]["unit"] == "N"


def test_the_mismatch_says_where():
    (mismatch,) = _documents(Plant(viscous=0.05))["mismatch"]
    assert mismatch["channel"] == "torque"
    assert mismatch["share"] == pytest.approx(1.0)
    assert mismatch["p_value"] < 1e-6
    assert mismatch["regime"]["variable"] in ("speed", "velocity")


def test_one_run_alone_is_judged_with_a_warning():
    check_diagnosis(document := _documents(Plant(friction=0.3), runs=1), "joint")
    assert document["fit"]["gap_closed"] is None
    assert document["fit"]["held_out_runs"] == []
    assert [effect["name"] for effect in document["effects"]] == ["coulomb_friction"]


def test_the_same_recording_gives_the_same_bytes(tmp_path):
    for name in ("first", "second"):
        diagnosis = quick(joint_recording(Plant(friction=0.3, viscous=0.04)), joint_simulator(), FEW)
        write_json(diagnosis_document(diagnosis), tmp_path / name / "diagnosis.json")
        write_simulator(diagnosis.simulator, tmp_path / name)
        write_evidence(diagnosis, tmp_path / name / "evidence")
    first, second = (
        {path.relative_to(tmp_path / name): path.read_bytes() for path in (tmp_path / name).rglob("*.*")}
        for name in ("first", "second")
    )
    assert first == second
    assert len(first) == 13
    assert b"NaN" not in b"".join(content for path, content in first.items() if path.suffix == ".json")
    assert read_simulator(tmp_path / "first") == diagnosis.simulator


numbers = st.floats() | st.integers() | st.text() | st.none()


@given(
    st.recursive(numbers, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner), max_leaves=20)
)
def test_what_is_not_finite_is_written_as_null(tmp_path_factory, content):
    path = tmp_path_factory.mktemp("json") / "file.json"
    write_json(content, path)
    read = json.loads(path.read_text(encoding="utf-8"), parse_constant=lambda name: pytest.fail(name))
    if isinstance(content, float):
        assert read == (content if math.isfinite(content) else None)
