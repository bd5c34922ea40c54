"""A contradiction that is likely and not clear: names hold only if there is none."""

import functools

import pytest

from simgap.consistency import check, contradictions
from simgap.consistency.checked import Checked
from simgap.diagnosis.diagnose import Diagnosis, diagnose
from simgap.gap.settings import Gap
from simgap.plants.concealed import record_concealed
from simgap.platforms import platform_from_config
from simgap.recordings.contradiction import Contradiction
from simgap.simulation import Simulator
from tests.pipeline.consistency.corruption import CORRUPTIONS
from tests.pipeline.consistency.plants import cases
from tests.pipeline.gap.recordings import JOINT, Plant, joint_recording

SUSPECTED = Contradiction("position", "rotations", "'effort' against the motion", "Convert it.")
SETTINGS = Gap(effects=["coulomb_friction", "viscous_friction"], resamples=50, horizon=0.05)


def test_viscous_friction_might_explain_rotations_too():
    """Nothing was lost beside friction of seven times the back-EMF, so rotations are likely and not clear."""
    case = cases("joint", 9010, 12)[3]
    (corruption,) = (each for each in CORRUPTIONS["joint"] if each.name == "both in rotations")
    recording, platform = record_concealed(case)[0], platform_from_config(case.platform)
    assert check(recording, platform) == Checked()
    found = check(corruption.of(recording, case.platform), platform)
    assert not found.contradictions
    assert found.suspected
    assert found.suspected.suspected == "rotations"
    assert 0.5 < found.doubt < 0.95


def test_a_law_may_come_into_doubt_where_exact_series_agree_again():
    """Beside a spring that stiffens, the one of the platform looks wrong once the position has its right sign."""
    case = cases("joint", 9060, 12)[0]
    assert case.effects == ("cubic_stiffness",)
    (corruption,) = (each for each in CORRUPTIONS["joint"] if each.name == "position negative")
    recording, platform = record_concealed(case)[0], platform_from_config(case.platform)
    (found,) = contradictions(corruption.of(recording, case.platform), platform)
    assert (found.column, found.suspected) == ("position", "sign")


def test_a_wrong_sign_is_no_lag():
    """A tenth of a second later the effort would have its right sign again, and leave five times as much."""
    case = cases("joint", 9080, 12)[10]
    assert case.effects == ("motor_lag",)
    (corruption,) = (each for each in CORRUPTIONS["joint"] if each.name == "effort negative")
    recording, platform = record_concealed(case)[0], platform_from_config(case.platform)
    assert check(recording, platform) == Checked()
    (found,) = contradictions(corruption.of(recording, case.platform), platform)
    assert (found.column, found.suspected) == ("effort", "sign")


@functools.cache
def diagnosed(checked: Checked) -> Diagnosis:
    """Return the diagnosis of a joint that rubs."""
    return diagnose(joint_recording(Plant(friction=0.3)), Simulator(JOINT), SETTINGS, checked)


@pytest.mark.slow
@pytest.mark.parametrize("doubt", [0.0, 0.04, 0.3, 0.8])
def test_names_hold_only_if_the_columns_are_what_they_are_taken_for(doubt):
    sure = diagnosed(Checked())
    found = diagnosed(Checked((), SUSPECTED, doubt))
    assert found.probabilities == {
        key: pytest.approx((1.0 - doubt) * probability, abs=0.006)
        for key, probability in sure.probabilities.items()
    }
    assert found.naming.probabilities.keys() == sure.naming.probabilities.keys()
    assert found.verdict == ("unexplained" if doubt > 0.5 else sure.verdict)
    said = [warning for warning in found.warnings if SUSPECTED.sentence in warning]
    assert said == (list(found.warnings[:1]) if doubt >= 0.05 else [])
