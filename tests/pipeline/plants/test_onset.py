"""Something that breaks between two runs of a concealed plant."""

import pytest
import yaml

from simgap.errors import InputError
from simgap.plants import case_from_config, record_case
from simgap.plants.sealing import key_hash
from simgap.platforms import platform_from_config
from tests.pipeline.gap.recordings import ROOT

MACHINES = {
    "quadrotor": ("racer", {"effects": {"rotor_fault": {"loss_2": 0.2}}, "autopilot": "trimmed"}),
    "joint": ("servo", {"effects": {"viscous_friction": {"coefficient": 0.05}}}),
    "swerve": ("swerve_robot", {"effects": {"viscous_friction@drive": {"coefficient": 0.02}}}),
}


def recorded(kind: str, **case):
    """Return a short recording of a machine with an effect, and its key."""
    name, concealed = MACHINES[kind]
    platform = platform_from_config(yaml.safe_load((ROOT / f"conf/platform/{name}.yaml").read_text()))
    known = concealed | {"runs": 3, "duration": 1.0} | case
    return record_case(case_from_config(kind, known), platform, 5)


@pytest.mark.slow
@pytest.mark.parametrize("kind", MACHINES)
def test_runs_before_are_without_the_effect_and_those_after_with_it(kind):
    begun, key = recorded(kind, begins_in_run=3)
    always, whole = recorded(kind)
    never, _ = recorded(kind, effects={})
    for run, other in zip(begun.runs, [never, never, always], strict=True):
        mine, theirs = (each.frame[each.frame["run"] == run] for each in (begun, other))
        columns = [column for column in mine if column not in ("run", "t")]
        assert (mine[columns].to_numpy() == theirs[columns].to_numpy()).all()
    assert key == {**whole, "acts_in_runs": always.runs[2:]}
    assert key_hash(key) in begun.source


@pytest.mark.parametrize("first", [0, 4])
def test_a_run_that_is_not_recorded_is_refused(first):
    with pytest.raises(InputError, match=r"record\.begins_in_run"):
        recorded("joint", begins_in_run=first)
