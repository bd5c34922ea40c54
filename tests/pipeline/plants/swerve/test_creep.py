"""Creep of a concealed robot's tyres as the catalogue's law finds it, and as the key tells it."""

import pytest
import torch

from simgap.effects.catalogue import effect_by_key
from simgap.plants import record_case
from simgap.plants.swerve.case import SwerveCase, SwerveSensors
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.signals import recorded_signals

SHORT = {"runs": 4, "duration": 1.0}
PERFECT = SwerveSensors(scale=0.0)


@pytest.mark.parametrize(
    ("effects", "compliance"),
    [({"wheel_slip@drive": {"stiffness": 25.0}}, 0.04), ({"tyre_creep@drive": {}}, None)],
)
def test_tyres_that_slide_creep_and_the_key_says_so(robot, effects, compliance):
    _, key = record_case(SwerveCase(effects=effects, **SHORT), robot, seed=1)
    stated = [entry["parameters"]["compliance"]["value"] for entry in key["beside"]]
    assert stated == ([] if compliance is None else [compliance])


def test_the_catalogues_creep_finds_the_compliance_of_the_key(robot):
    """From rolling and drifting in a perfect recording, over all of what is driven."""
    case = SwerveCase(effects={"tyre_creep@drive": {}}, **SHORT, sensors=PERFECT)
    recording, key = record_case(case, robot, seed=1)
    told = key["effects"][0]["parameters"]["compliance"]["value"]
    creep = effect_by_key("swerve", "tyre_creep@drive")
    sides: dict[float, list[torch.Tensor]] = {0.0: [], 1e-3: []}
    for _, frame in recording.frame.groupby("run"):
        signals = recorded_signals(frame.reset_index(drop=True), robot)
        series = {name: values[None] for name, values in signals.items()}
        for compliance, rows in sides.items():
            machine = Simulator(robot, (FittedEffect(creep, {"compliance": compliance}),))
            readings = machine.mechanism.readings(machine.along_time(series, 0.01), machine.constants())
            rows += [
                (readings[f"rolling_{n}"][0] - readings[f"rolling_{n}"][1]).flatten() for n in range(1, 5)
            ]
    left, changed = (torch.cat(rows) for rows in sides.values())
    law = (left - changed) / 1e-3
    found = float((law * left).sum() / (law * law).sum())
    assert found == pytest.approx(told, rel=0.15)
    assert (left - found * law).square().sum() < 0.05 * left.square().sum()
