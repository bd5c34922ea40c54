"""What is known of the published flights."""

import numpy as np
import pytest

from simgap.recordings.cleaning import clean_with_coverage
from simgap.recordings.importers import importer


@pytest.fixture(scope="module")
def brushless(shared_data):
    names = ("melon_20251017_run1", "melon_20251017_run2", "multisine_20251017_run1", "random2_20251017_run1")
    files = [shared_data / "nanodrone" / "raw_parquet" / f"{name}.parquet" for name in names]
    return clean_with_coverage(importer("nanodrone")(files, {}))


@pytest.fixture(scope="module")
def brushed(shared_data):
    names = ("B6_linear_ramp_rep1", "B9_trefoil_fast_rep2", "B7_oval_fast_rep2")
    files = [shared_data / "nanobench" / f"{name}.csv" for name in names]
    return clean_with_coverage(importer("nanobench")(files, {}))


def changes_of(cleaned, run, step):
    changes = cleaned.changes
    return changes[changes["run"].str.contains(run) & (changes["step"] == step)]


def test_the_two_wrong_rotor_speeds_of_the_multisine_are_replaced(brushless):
    spikes = changes_of(brushless, "multisine", "spikes")
    assert dict(zip(spikes["column"], spikes["samples"], strict=True)) == {
        "motor_speed_3": 1,
        "motor_speed_4": 1,
    }
    speeds = brushless.recording.frame[[f"motor_speed_{rotor}" for rotor in "1234"]]
    assert speeds.max().max() < 2600


def test_a_quarter_of_the_random_flight_was_held(brushless):
    frozen = changes_of(brushless, "random2", "frozen").set_index("column")["samples"]
    assert frozen["velocity_x"] / 6419 == pytest.approx(0.27, abs=0.01)
    assert frozen["motor_speed_1"] / 6419 == pytest.approx(0.41, abs=0.01)
    assert changes_of(brushless, "random2", "gaps").empty


def test_the_crashed_flight_is_cut_off_where_its_estimate_is_lost(brushless):
    crash = changes_of(brushless, "melon_20251017_run2", "crash")
    assert len(crash) == 1
    rest = brushless.recording.frame.query("run == 'melon_20251017_run2'")
    assert 58.0 < rest["t"].iloc[-1] < 60.5
    assert np.abs(rest[["position_x", "position_y"]]).max().max() < 1.5


def test_a_good_flight_loses_nothing_but_its_landing(brushless):
    rows = brushless.changes[
        (brushless.changes["run"] == "melon_20251017_run1") & (brushless.changes["column"] == "")
    ]
    assert set(rows["step"]) == {"idle"}
    assert rows["samples"].sum() > -100


def test_clock_offsets_are_those_of_the_brute_force_scan(brushless):
    """Found by regressing angular accelerations on shifted rotor speeds, in steps of 0.05 samples."""
    expected = {
        "melon_20251017_run1": 0.0035,
        "melon_20251017_run2": -0.0175,
        "multisine_20251017_run1": 0.0038,
    }
    for run, offset in expected.items():
        assert brushless.recording.clock_offset[run] == pytest.approx(offset, abs=0.001)
    rows = changes_of(brushless, "melon_20251017_run2", "clock").set_index("column")["seconds"]
    assert rows["specific_force_z"] == pytest.approx(-0.0235, abs=0.003)  # the accelerometer has its own


def test_what_the_authors_extrapolated_is_not_taken_for_flight(brushed):
    straight = changes_of(brushed, "B9_trefoil_fast_rep2", "straight").set_index("column")["samples"]
    assert straight["body_rate_x"] == pytest.approx(2978, abs=20)
    frame = brushed.recording.frame
    commands = frame[[f"motor_command_{rotor}" for rotor in "1234"]]
    assert commands.max().max() <= 1.001
    assert frame.query("run == 'B9_trefoil_fast_rep2'")["t"].max() < 13.0


def test_only_the_ground_is_cut_from_a_good_flight(brushed):
    rows = changes_of(brushed, "B7_oval", "idle")
    assert rows["samples"].sum() == pytest.approx(-542, abs=10)
    kept = brushed.recording.frame.query("run == 'B7_oval_fast_rep2'")
    assert kept["segment"].nunique() == 1


def test_commands_alone_give_no_clock_offset(brushed):
    assert brushed.recording.clock_offset == {}
