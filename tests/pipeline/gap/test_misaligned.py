"""Wheels that point elsewhere drag, and their motors are those of the platform: recorded from the concealed plant."""

import pytest

from simgap.diagnosis.diagnose import diagnose
from simgap.gap.settings import Gap
from simgap.plants import case_from_config, record_case
from simgap.platforms import platform_from_config
from simgap.recordings.cleaning import clean_with_coverage
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.split import Split
from simgap.runner.compose import compose
from simgap.simulation import Simulator

pytestmark = pytest.mark.slow

KEY = "module_misalignment@chassis"
ALIKE = [KEY, "motor_constant_error@drive", "viscous_friction@drive", "mass_error@drive"]

CASES = {
    "measured": ((0.12, 0.0, 0.01, 0.1), ["chassis"], [4]),
    "rolled": ((0.024, 0.013, -0.049, -0.03), [], [4, 5, 6]),
}


@pytest.mark.parametrize(("offsets", "channels", "seeds"), CASES.values(), ids=CASES)
def test_the_drag_of_misaligned_wheels_is_no_other_motor(offsets, channels, seeds):
    """On average over recordings: one without the chassis tells an offset of a wheel to 0.0045 only."""
    values = {f"offset_{module}": offset for module, offset in enumerate(offsets, start=1)}
    found = [_named(values, channels, seed) for seed in seeds]
    mean = {name: sum(each[name] for each in found) / len(found) for name in values}
    assert mean == pytest.approx(values, rel=0.15, abs=0.005)


def _named(values: dict[str, float], channels: list[str], seed: int) -> dict[str, float]:
    """Conceal offsets in a recording, and return what is found of them, which is all that may be believed."""
    platform = platform_from_config(compose(["platform=swerve_trolley"])["platform"])
    concealed = {KEY: values | {"cornering_stiffness": 15.0}}
    drawn = {"effects": concealed, "runs": 5, "duration": 8.0, "rate": 50.0, "channels": channels}
    recording, _ = record_case(case_from_config("swerve", drawn), platform, seed=seed)
    cleaned = clean_with_coverage(recording, Cleaning(), Split(holdout=["weave_*"]), 0).recording
    named = diagnose(cleaned, Simulator(platform), Gap(effects=ALIKE)).naming.named
    assert [candidate.effect.key for candidate in named if candidate.probability > 0.5] == [KEY]
    return named[0].fitted.values
