"""Lines of a mapping that correct a proposal, and motors that are taken by their places."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from simgap.errors import InputError
from simgap.logs.opening import open_recording
from tests.pipeline.logs import vehicle
from tests.pipeline.logs.test_px4 import flown, written

RACER = yaml.safe_load((vehicle.ROOT / "conf/platform/racer.yaml").read_text())


def opened(folder: Path, lines: str, topics: dict | None = None) -> dict[str, np.ndarray]:
    """Return the columns of a flight with a mapping of these lines."""
    mapping = folder / "mine.yaml"
    mapping.write_text(f"kind: quadrotor\n{lines}")
    frame = open_recording(written(folder, topics or flown()), "quadrotor", mapping).frame
    return {name: frame[name].to_numpy() for name in frame.columns[2:]}


def test_a_line_that_names_a_column_corrects_what_is_proposed_and_keeps_the_rest(tmp_path: Path) -> None:
    plain = opened(tmp_path, "body_rate_x: {from: body_rate_x}")
    assert plain.keys() == set(open_recording(written(tmp_path, flown()), "quadrotor").channels)
    changed = opened(
        tmp_path,
        "body_rate_y: {from: body_rate_y, sign: -1, unit: deg/s}\n"
        "motor_command_1: {from: motor_command_2, root: true}\n",
    )
    np.testing.assert_allclose(changed["body_rate_y"], -np.radians(plain["body_rate_y"]))
    np.testing.assert_allclose(changed["motor_command_1"], np.sqrt(plain["motor_command_2"]))
    for name in plain.keys() - {"body_rate_y", "motor_command_1"}:
        np.testing.assert_array_equal(changed[name], plain[name])


def test_beside_lines_that_name_signals_the_rest_is_left_out(tmp_path: Path) -> None:
    signals = "".join(
        f"body_rate_{axis}: {{from: 'vehicle_angular_velocity.xyz[{place}]'}}\n"
        for place, axis in enumerate("xyz")
    )
    motors = "".join(f"motor_command_{rotor}: {{from: motor_command_{rotor}}}\n" for rotor in range(1, 5))
    assert set(opened(tmp_path, signals + motors)) == {
        *(f"body_rate_{axis}" for axis in "xyz"),
        *(f"motor_command_{rotor}" for rotor in range(1, 5)),
    }


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("estimate_position_x: {from: estimate_position_x}", "none is proposed for it"),
        ("body_rate_x: {from: body_rate_x, offset: 1}", "is no signal of the log"),
    ],
)
def test_a_line_that_cannot_be_a_correction_is_refused(tmp_path: Path, line: str, said: str) -> None:
    with pytest.raises(InputError, match=said):
        opened(tmp_path, line)


def test_motors_are_taken_by_their_places(tmp_path: Path) -> None:
    """The racer counts its rotors otherwise than PX4: the same flight has the columns of the racer."""
    path = written(tmp_path, flown())
    own = open_recording(path, "quadrotor").frame
    recording = open_recording(path, "quadrotor", platform=RACER)
    assert "rotors 1 to 4 of the platform file are motors 1, 4, 2 and 3 of the log" in " ".join(
        recording.warnings
    )
    frame = recording.frame
    for number, mine in enumerate(vehicle.ORDER, 1):
        np.testing.assert_array_equal(frame[f"motor_command_{mine}"], own[f"motor_command_{number}"])


def test_rotors_that_stand_elsewhere_are_left_as_they_are(tmp_path: Path) -> None:
    plus = RACER | {"rotor_positions": [[0.1, 0, 0], [-0.1, 0, 0], [0, 0.1, 0], [0, -0.1, 0]]}
    path = written(tmp_path, flown())
    frame = open_recording(path, "quadrotor", platform=plus).frame
    np.testing.assert_array_equal(
        frame["motor_command_1"], open_recording(path, "quadrotor").frame["motor_command_1"]
    )
