"""What the engine still gets wrong: cases with a right answer that are expected to fail until it is mended.

None of them is bent to the answer that comes. One that passes again is reported as XPASS; then its line goes.
"""

import pytest

OPEN = {
    "test_contract.py::test_every_verdict_is_written_as_the_contract_says[unexplained]": (
        "a damping that varies with the angle is outside the catalogue and gets the name of another friction"
    ),
    "test_real_recordings.py::test_rotor_drag_and_inflow_of_a_real_quadrotor": (
        "mass and thrust coefficient are both named at a third: together they make the torques small"
    ),
    "test_name_joint.py::test_friction_and_a_wrong_number_show_only_beside_a_load_and_a_delay": (
        "the search does not visit the true set of four effects, which scores higher than what it finds"
    ),
    "test_name_joint.py::test_of_a_quarter_of_a_second_nothing_is_said_but_that_it_is_too_short": (
        "the true friction is named from a sixth of a second: its prior odds are even"
    ),
    "test_name_joint.py::test_two_wrong_numbers_do_not_conspire_to_be_friction_nor_the_reverse": (
        "viscous friction stands in for a wrong inertia beside a wrong motor constant"
    ),
    "test_name_joint.py::test_clocks_that_are_a_tenth_of_a_sample_apart_are_no_cause[0.1]": (
        "a velocity filter within the tolerance of timing takes the place of the delay; neither is named"
    ),
    "test_name_swerve.py::test_what_the_drive_lacks_is_named_alone_with_its_value[coulomb_friction@drive-level-1.5]": (
        "friction that fades with speed is named beside the dry friction of the wheels"
    ),
    "test_name_quadrotor.py::test_the_concealed_effect_is_named_and_no_other[body_drag]": (
        "axial inflow is named beside the drag of the body"
    ),
    "test_name_quadrotor.py::test_a_wind_is_named_beside_the_drag_through_which_it_pushes": (
        "wind and drag show only together and are not tried together where a linearisation does not promise it"
    ),
    "test_name_quadrotor.py::test_commands_that_are_held_to_the_next_sample_are_not_called_late": (
        "the odds against held commands of a multirotor make it a delay of half a sample beside the lag"
    ),
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the cases above."""
    for item in items:
        for case, reason in OPEN.items():
            if item.nodeid.endswith(f"tests/pipeline/gap/{case}"):
                item.add_marker(pytest.mark.xfail(reason=reason, strict=False))
