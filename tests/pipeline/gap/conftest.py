"""What the engine still gets wrong: cases with a right answer that are expected to fail until it is mended.

None of them is bent to the answer that comes. One that passes again fails the tests until its line goes.
"""

import pytest

_CASE = "test_real_recordings.py::test_what_a_real_machine_is_known_to_have_is_believed_and_nothing_else"
OPEN = {
    f"{_CASE}[f1tenth_speed]": "steps from rest: friction and the inductance of a winding stand in for lag and delay",
    f"{_CASE}[dfki_pendulum]": "Coulomb friction explains a third of one channel in twelve samples: 0.3",
    f"{_CASE}[hsm150]": "friction that grows with the load, in two of six runs, beside asymmetric friction: 0.45",
    "test_real_recordings.py::test_rotor_drag_and_inflow_of_a_real_quadrotor": (
        "both are named, but the drag is 0.38 1/s where the authors have about 0.45"
    ),
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark the cases above."""
    for item in items:
        for case, reason in OPEN.items():
            if item.nodeid.endswith(f"tests/pipeline/gap/{case}"):
                item.add_marker(pytest.mark.xfail(reason=reason, strict=True))
