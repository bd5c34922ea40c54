import math

import pytest

from simgap.models.output_groups import group_scores


def test_motors_and_axes_are_taken_together_and_what_stands_alone_is_not():
    values = {
        "steer_velocity": 9.0,  # all motors together: no member
        "steer_velocity_1": 1.0,
        "steer_velocity_2": 3.0,
        "body_rate_x": 2.0,
        "body_rate_y": 2.0,
        "body_rate_z": 5.0,
        "drive_velocity_1": 4.0,
        "chassis_rate": 7.0,
    }
    found = group_scores({name: {"mse": value, "mae": 2.0 * value} for name, value in values.items()})
    assert list(found) == ["steer_velocity", "body_rate"]
    assert found["steer_velocity"] == {"mean": {"mse": 2.0, "mae": 4.0}, "variance": {"mse": 1.0, "mae": 4.0}}
    assert found["body_rate"]["mean"]["mse"] == pytest.approx(3.0)
    assert found["body_rate"]["variance"]["mse"] == pytest.approx(2.0)


def test_a_score_that_one_output_lacks_is_unknown_over_all():
    (group,) = group_scores({"v_1": {"r_squared": math.nan}, "v_2": {"r_squared": 1.0}}).values()
    assert math.isnan(group["mean"]["r_squared"])
    assert math.isnan(group["variance"]["r_squared"])
