from benchmarks import diagnosis
from benchmarks.diagnosis import catalogue, recording_of, written
from simgap.effects import effects_of


def test_the_recording_is_of_a_joint_that_moves(monkeypatch):
    monkeypatch.setattr(diagnosis, "RUN", 0.8)  # s: what holds of short runs holds of long ones
    recording = recording_of(3.2)
    assert len(recording.runs) == 4
    assert recording.frame["velocity"].abs().max() > 1.0
    assert set(recording.split.values()) == {"train", "holdout"}


def test_the_catalogue_begins_with_what_is_there_and_is_whole():
    assert catalogue()[:2] == ["coulomb_friction", "viscous_friction"]
    assert sorted(catalogue()) == sorted(effect.key for effect in effects_of("joint"))


def test_the_page_states_median_and_greatest_time_of_each_kind():
    results = [{"seed": 5, "case": {"kind": "joint"}, "seconds_busy": time} for time in (3.0, 4.0, 9.0)]
    page = written(
        [*results, {"branch": "omni_drive", "seconds_busy": 99.0}],
        ([["40", "8,000", "2.0"]], []),
        1,
        0.0,
        "make bench",
    )
    assert "| joint | 3 | 4.0 | 9.0 | 5 | met |" in page
    assert "Seed 5, 3 cases." in page
