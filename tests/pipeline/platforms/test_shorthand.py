"""A swerve drive by what a person measures: size and wheel; and what was assumed is said."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.platforms import Joint, Swerve, platform_assumptions, platform_from_config, platform_to_config
from tests.pipeline.platforms.machines import MACHINES, SWERVE

LENGTH = st.floats(0.01, 5.0)


def drive(*left_out: str, **given_keys: object) -> dict[str, object]:
    kept = {key: value for key, value in platform_to_config(SWERVE).items() if key not in left_out}
    return kept | given_keys


@given(length=LENGTH, width=LENGTH)
def test_a_size_stands_for_a_uniform_rectangle(length, width):
    """Cut into four equal ones, its inertia is that of the parts by the parallel axis theorem."""
    config = drive("inertia", size=[length, width])
    swerve = platform_from_config(config)
    assert isinstance(swerve, Swerve)
    quarter = SWERVE.mass / 4.0
    own = quarter * ((length / 2) ** 2 + (width / 2) ** 2) / 12.0
    moved = quarter * ((length / 4) ** 2 + (width / 4) ** 2)
    assert swerve.inertia == pytest.approx(4.0 * (own + moved))
    (said,) = platform_assumptions(config)
    assert "uniform rectangle" in said


def test_the_inertia_of_a_known_plate():
    assert platform_from_config(drive("inertia", size=[0.75, 0.75])).inertia == pytest.approx(5.0625)


@pytest.mark.parametrize(
    "wheel",
    [{"wheel_diameter": 0.1016}, *({"wheel": {"diameter": size, "unit": unit}} for size, unit in
     [(4, "in"), (0.1016, "m"), (10.16, "cm"), (101.6, "mm"), (4 / 12, "ft")])],
)  # fmt: skip
def test_a_wheel_by_its_diameter(wheel):
    assert platform_from_config(drive("wheel_radius", **wheel)).wheel_radius == pytest.approx(0.0508)
    assert platform_assumptions(drive("wheel_radius", **wheel)) == ()


@pytest.mark.parametrize(
    ("config", "line"),
    [
        (drive(size=[1.0, 1.0]), "platform: 'inertia' and 'size' say the same"),
        (drive("inertia", size=0.75), "platform.size: a list of length and width in m is needed, not 0.75"),
        (drive("inertia", size=[0.75, -1.0]), "platform.size[1]: a positive number is needed, not -1.0"),
        (drive("inertia", size=[0.75, "1"]), "platform.size[1]: a positive number is needed, not '1'"),
        (drive("inertia", "mass", size=[1.0, 1.0]), "platform.mass: a positive number is needed, not None"),
        (drive("inertia"), "platform: key 'inertia' is missing"),
        (drive(wheel_diameter=0.1), "platform: 'wheel_radius' and 'wheel_diameter' say the same"),
        (
            drive("wheel_radius", wheel_diameter=0),
            "platform.wheel_diameter: a positive number is needed, not 0",
        ),
        (drive("wheel_radius", wheel=4), "platform.wheel: is 4; give it as {diameter: 4, unit: in}"),
        (drive("wheel_radius", wheel={"diameter": 4}), "give it as {diameter: 4, unit: in}"),
        (
            drive("wheel_radius", wheel={"diameter": 4, "unit": "inch"}),
            "platform.wheel.unit: unknown unit 'inch'; use one of m, cm, mm, in, ft",
        ),
    ],
)
def test_what_is_no_wheel_or_size_is_refused_with_its_key(config, line):
    with pytest.raises(InputError) as refused:
        platform_from_config(config)
    assert line in str(refused.value)


@pytest.mark.parametrize("kind", list(MACHINES))
def test_a_platform_in_plain_keys_assumes_nothing(kind):
    assert platform_assumptions(platform_to_config(MACHINES[kind])) == ()


def test_sentences_of_the_file_are_kept():
    config = {"inertia": 1.0, "assumptions": ["The rod is uniform."]}
    assert platform_from_config(config) == Joint(1.0)
    assert platform_assumptions(config) == ("The rod is uniform.",)
    with pytest.raises(InputError, match=r"platform.assumptions: a list of sentences is needed"):
        platform_from_config({"inertia": 1.0, "assumptions": "none"})
