"""WPILib DataLogs: numbers, arrays, structs, times and tests of SysId; and damaged files."""

import contextlib
import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.formats import read_log
from simgap.logs.log import Log
from simgap.logs.proposal import propose
from tests.pipeline.logs.wpilog_encoder import Writer, unit


def test_numbers_of_every_type(tmp_path: Path) -> None:
    log = Writer('{"extra": "header"}')
    kinds = {"boolean": "?", "int64": "q", "float": "f", "double": "d"}
    for kind, code in kinds.items():
        number = log.start(f"/{kind}", kind)
        for step in range(300):
            log.record(number, 20_000 * step, struct.pack(f"<{code}", step % 2))
    array = log.start("/pair", "double[]")
    log.double(array, 5, 1.5, 2.5)
    log.double(array, 10, 3.5)
    read = read_log(log.write(tmp_path / "a.wpilog"))
    for kind in kinds:
        np.testing.assert_array_equal(read.signals[f"/{kind}"].values, np.arange(300) % 2)
        np.testing.assert_allclose(read.signals[f"/{kind}"].time, 0.02 * np.arange(300))
    np.testing.assert_array_equal(read.signals["/pair[0]"].values, [1.5, 3.5])
    np.testing.assert_array_equal(read.signals["/pair[1]"].time, [5e-6])


def test_structs_by_the_schema_of_the_log(tmp_path: Path) -> None:
    log = Writer()
    log.struct_schema("Inner", "float32 a[2]; int16 b")
    log.struct_schema("Outer", "enum {off=0, on=1} uint8 mode; char label[3]; Inner inner;bool done")
    number = log.start("/thing", "struct:Outer[]")
    one = struct.pack("<B3sffh?", 1, b"abc", 0.5, 1.5, -7, True)
    log.record(number, 1, one)
    log.record(number, 2, one + struct.pack("<B3sffh?", 0, b"xyz", 2.5, 3.5, 9, False))
    log.record(number, 3, one[:-1])
    read = read_log(log.write(tmp_path / "a.wpilog"))
    assert read.signals["/thing[0]/inner/a[1]"].values.tolist() == [1.5, 1.5]
    assert read.signals["/thing[1]/inner/b"].values.tolist() == [9.0]
    assert read.signals["/thing[0]/mode"].values.tolist() == [1.0, 1.0]
    assert any("1 records have a wrong size" in remark for remark in read.remarks)


def test_structs_of_wpilib_need_no_schema_and_declare_their_units(tmp_path: Path) -> None:
    log = Writer()
    states = log.start("/Drive/Measured", "struct:SwerveModuleState[]")
    log.double(states, 10, 1.0, 0.1, 2.0, 0.2, 3.0, 0.3, 4.0, 0.4)
    chassis = log.start("/Drive/Speeds", "struct:ChassisSpeeds")
    log.double(chassis, 10, 1.0, -2.0, 3.0)
    unknown = log.start("/what", "struct:Home-made")
    log.double(unknown, 10, 1.0)
    read = read_log(log.write(tmp_path / "a.wpilog"))
    assert read.signals["/Drive/Measured[2]/speed"].values.tolist() == [3.0]
    assert read.signals["/Drive/Measured[2]/speed"].unit == "m/s"
    assert read.signals["/Drive/Measured[3]/angle/value"].unit == "rad"
    assert read.signals["/Drive/Speeds/omega"].unit == "rad/s"
    assert any("does not say what a struct:Home-made is" in remark for remark in read.remarks)


@pytest.mark.parametrize(
    ("name", "metadata", "expected"),
    [
        ("voltage-left-drive", "Volt", "V"),
        ("velocity-left-drive", "Rotation per Second", "rev/s"),
        ("velocity-left-drive", "meters_per_second", "m/s"),
        ("/Arm/Position", unit("radians"), "rad"),
        ("/Arm/Height", unit("inches"), "in"),
        ("/Drive/Module0/DriveVelocityRadPerSec", "", "rad/s"),
        ("/Shooter/VelocityRPM", "", "rpm"),
        ("/Odometer X Position (m)", '{"source":"NT"}', "m"),
        ("Phoenix6/TalonFX-3/Velocity", "", "rev/s"),
        ("/Arm/Position", '{"unit": 3}', None),
        ("/Arm/Position", "{broken", None),
        ("/Arm/Gradient", "", None),
    ],
)
def test_the_unit_of_an_entry(tmp_path: Path, name: str, metadata: str, expected: str | None) -> None:
    log = Writer()
    log.double(log.start(name, "double", metadata), 1, 1.0)
    assert read_log(log.write(tmp_path / "a.wpilog")).signals[name].unit == expected


def test_times_that_cannot_be_and_records_out_of_order(tmp_path: Path) -> None:
    log = Writer()
    number = log.start("/x", "double")
    for time, value in [(-5_000_000, 9.0), (10, 1.0), (30, 3.0), (20, 2.0), (30, 4.0), (1 << 62, 9.0)]:
        log.double(number, time, value)
    read = read_log(log.write(tmp_path / "a.wpilog"))
    assert read.signals["/x"].values.tolist() == [1.0, 2.0, 4.0]
    assert any("2 records have an invalid time" in remark for remark in read.remarks)
    assert any("out of order" in remark for remark in read.remarks)


def test_an_entry_that_is_started_anew_and_a_number_that_is_used_again(tmp_path: Path) -> None:
    log = Writer()
    first = log.start("/x", "double")
    log.double(first, 1, 1.0)
    log.finish(first)
    log.double(first, 2, 99.0)
    log.start("/y", "double", number=first)
    log.double(first, 3, 7.0)
    again = log.start("/x", "double", number=8)
    log.double(again, 4, 2.0)
    read = read_log(log.write(tmp_path / "a.wpilog"))
    assert read.signals["/x"].values.tolist() == [1.0, 2.0]
    assert read.signals["/y"].values.tolist() == [7.0]
    assert any("1 records belong to no entry" in remark for remark in read.remarks)


def test_memory_that_was_never_written_is_missing(tmp_path: Path) -> None:
    log = Writer()
    log.doubles("/x", np.arange(3.0), np.array([1.0, 1e-312, 0.0]))
    read = read_log(log.write(tmp_path / "a.wpilog"))
    np.testing.assert_array_equal(read.signals["/x"].values, [1.0, np.nan, 0.0])
    assert any("1 values were never set" in remark for remark in read.remarks)


def test_what_is_written_on_change_is_held(tmp_path: Path) -> None:
    time = 0.02 * np.arange(500)
    wave = np.sin(time)
    log = Writer()
    log.doubles("/always", time, np.round(wave, 1))
    log.doubles("/smooth", time, wave)
    changed = (time < 3.0) | (time > 5.0)
    log.doubles("/changed", time[changed], wave[changed])
    log.doubles("/once", time[:1], wave[:1])
    signals = read_log(log.write(tmp_path / "a.wpilog")).signals
    assert {name for name, signal in signals.items() if signal.held} == {"/changed", "/once"}


def _routine(log: Writer, name: str, tests: dict[str, tuple[float, float]], motors: tuple[str, ...]) -> None:
    time = np.arange(0.0, 10.0, 0.02)
    state = log.start(f"sysid-test-state-{name}", "string")
    for test, (begin, end) in tests.items():
        for moment in np.arange(begin, end, 0.02):
            log.text(state, round(moment * 1e6), test)
        log.text(state, round(end * 1e6), "none")
    for place, motor in enumerate(motors, 1):
        log.doubles(f"voltage-{motor}-{name}", time, place * np.sin(time), "Volt")
        log.doubles(f"position-{motor}-{name}", time, place * np.cos(time), "Rotation")
        log.doubles(f"velocity-{motor}-{name}", time, -place * np.sin(time), "Rotation per Second")


def test_the_tests_of_sysid_are_runs(tmp_path: Path) -> None:
    log = Writer()
    tests = {
        "quasistatic-forward": (1.0, 3.0),
        "quasistatic-reverse": (4.0, 6.0),
        "dynamic-forward": (7.0, 8.0),
    }
    _routine(log, "arm", tests, ("elbow",))
    read = read_log(log.write(tmp_path / "a.wpilog"))
    assert [span.name for span in read.spans] == list(tests)
    assert [(span.begin, round(span.end, 2)) for span in read.spans] == [(1.0, 3.0), (4.0, 6.0), (7.0, 8.0)]
    assert not any(name.startswith("sysid/") for name in read.signals)


def test_two_motors_of_sysid_lie_one_behind_the_other(tmp_path: Path) -> None:
    log = Writer()
    _routine(log, "drive", {"dynamic-forward": (1.0, 3.0)}, ("left", "right"))
    signals = read_log(log.write(tmp_path / "a.wpilog")).signals
    joined = signals["sysid/voltage"]
    assert (np.diff(joined.time) > 0).all()
    later = joined.time > 3.5
    np.testing.assert_allclose(joined.values[later], 2.0 * joined.values[~later])


def test_the_times_in_which_a_robot_is_enabled_are_runs(tmp_path: Path) -> None:
    log = Writer()
    log.doubles("/x", np.arange(0.0, 100.0), np.arange(100.0))
    enabled = log.start("DS:enabled", "boolean")
    for time, on in [(0, False), (10, True), (25, False), (40, True), (40.5, False), (60, True)]:
        log.record(enabled, int(time * 1e6), bytes([on]))
    spans = read_log(log.write(tmp_path / "a.wpilog")).spans
    assert [(span.name, span.begin, span.end) for span in spans] == [
        ("enabled-1", 10.0, 25.0),
        ("enabled-2", 60.0, 99.0),
    ]


def test_a_file_that_ends_within_a_record(tmp_path: Path) -> None:
    log = Writer()
    log.doubles("/x", np.arange(3.0), np.arange(3.0))
    path = tmp_path / "a.wpilog"
    path.write_bytes(log.bytes()[:-3])
    read = read_log(path)
    assert read.signals["/x"].values.tolist() == [0.0, 1.0]
    assert any("ends within a record" in remark for remark in read.remarks)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"WPILOG", "is no WPILib DataLog"),
        (b"WPILOG\0\2" + bytes(4), "has version 2.0"),
        (b"WPILOG\0\1" + b"\xff" * 4, "ends within its header"),
        (b"WPILOG\0\1" + bytes(4), "holds no signal"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused(tmp_path: Path, content: bytes, said: str) -> None:
    (tmp_path / "a.wpilog").write_bytes(content)
    with pytest.raises(InputError, match=said):
        read_log(tmp_path / "a.wpilog")


def _small() -> bytes:
    log = Writer()
    log.struct_schema("Pair", "double a;Pose2d b[2]")
    log.record(log.start("/pair", "struct:Pair"), 1, bytes(56))
    _routine(log, "arm", {"dynamic-forward": (0.1, 0.2)}, ())
    log.doubles("/x", np.arange(5.0), np.arange(5.0))
    log.double(log.start("/array", "double[]"), 7, 1.0, 2.0)
    for name in ("DriveAppliedVolts", "DriveVelocityRadPerSec", "DrivePositionRad", "TurnPosition"):
        log.doubles(f"/Drive/Module1/{name}", 0.02 * np.arange(5), np.arange(5.0))
    log.record(log.start("DS:enabled", "boolean"), 1, b"\1")
    return log.bytes()


_SMALL = _small()


@settings(max_examples=50)
@given(
    end=st.integers(0, len(_SMALL)),
    flips=st.lists(st.tuples(st.integers(0, len(_SMALL) - 1), st.integers(1, 255)), max_size=4),
)
def test_a_damaged_file_is_read_or_refused(
    tmp_path_factory: pytest.TempPathFactory, end: int, flips: list
) -> None:
    content = bytearray(_SMALL)
    for place, change in flips:
        content[place] ^= change
    path = tmp_path_factory.getbasetemp() / "damaged.wpilog"
    path.write_bytes(content[:end])
    with contextlib.suppress(InputError):
        read = read_log(path)
        assert isinstance(read, Log)
        for kind in ("joint", "swerve", None):
            propose(read, kind)


@pytest.mark.parametrize(
    ("folder", "file", "signal", "said"),
    [
        (
            "wpilog_swerve_match_tan560",
            "FRC_20240910_002841",
            "/Chassis/ActualSpeed/vx",
            "27 records have an invalid",
        ),
        ("wpilog_misc_devs", "FRC_20220701_010412", "NT:/LiveWindow/Ungrouped/Encoder[1]/Speed", ""),
        ("wpilog_akit_sim_husky", "Log_23-06-23_19-38-49", "/Mod1/DriveVelocityMetersPerSec", "never set"),
    ],
)
def test_logs_of_real_robots(shared_data: Path, folder: str, file: str, signal: str, said: str) -> None:
    read = read_log(shared_data / "raw" / folder / f"{file}.wpilog")
    assert len(read.signals[signal].time)
    assert said in " ".join(read.remarks)
    for each in read.signals.values():
        assert (np.diff(each.time) > 0).all(), each.name
        assert not np.any((np.abs(each.values) > 0) & (np.abs(each.values) < 1e-300))
