"""DataFlash: what was written is read, by letters, scales, instances and clocks; damage costs what it hits."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from simgap.errors import InputError
from simgap.logs.formats import format_of, read_log
from simgap.logs.readers.dataflash import read
from tests.pipeline.logs.damage import assert_a_log_or_one_line, damaged
from tests.pipeline.logs.dataflash_encoder import dataflash, instances

TIME = 2_000_000 + 20_000 * np.arange(40)
MESSAGES = {
    "ATT": ("QcC", {"TimeUS": TIME, "Roll": np.linspace(-3, 3, 40), "Yaw": np.linspace(300, 359, 40)}),
    "GPS": ("QLf", {"TimeUS": TIME[::5], "Lat": np.full(8, 47.1234567), "Alt": np.arange(8.0)}),
    "IMU": (
        "QBf",
        instances({"TimeUS": TIME, "GyrX": np.arange(40.0)}, {"TimeUS": TIME, "GyrX": -np.arange(40.0)}),
    ),
    "EV": ("QB", {"TimeUS": TIME[[3, 30]], "Id": [10, 11]}),
}
UNITS = {"IMU": "-#-"}
CONTENT = dataflash(MESSAGES, {"FRAME_TYPE": 1, "MOT_PWM_MIN": 1000, "WPNAV_SPEED": 500}, units=UNITS)


def written(folder: Path, content: bytes) -> Path:
    path = folder / "00000001.BIN"
    path.write_bytes(content)
    return path


def test_numbers_scales_and_instances(tmp_path: Path) -> None:
    path = written(tmp_path, CONTENT)
    assert format_of(path).name == "ArduPilot DataFlash"
    log = read_log(path)
    signals = log.signals
    np.testing.assert_allclose(signals["ATT.Roll"].values, MESSAGES["ATT"][1]["Roll"], atol=0.0051)
    np.testing.assert_allclose(signals["GPS.Lat"].values, 47.1234567)
    np.testing.assert_array_equal(signals["IMU.GyrX"].values, np.arange(40.0))
    np.testing.assert_array_equal(signals["IMU[1].GyrX"].values, -np.arange(40.0))
    np.testing.assert_allclose(signals["IMU[1].GyrX"].time, TIME / 1e6)
    assert signals["EV.Id"].held
    assert log.remarks == ()


def test_the_vehicle_its_frame_and_its_motors_are_told(tmp_path: Path) -> None:
    assert read(written(tmp_path, CONTENT)).facts == {
        "firmware": "ArduCopter V4.5.0 (00000000)", "vehicle": "Copter", "frame": "QUAD/X",
        "FRAME_TYPE": "1", "MOT_PWM_MIN": "1000",
    }  # fmt: skip


def test_declared_units(tmp_path: Path) -> None:
    messages = {"RATE": ("Qff", {"TimeUS": TIME, "R": np.zeros(40), "AccZ": np.zeros(40)})}
    signals = read(written(tmp_path, dataflash(messages, units={"RATE": "-ko"}))).signals
    assert (signals["RATE.R"].unit, signals["RATE.AccZ"].unit) == ("deg/s", "m/s²")


def test_old_clocks(tmp_path: Path) -> None:
    """Milliseconds; of GPS those of the vehicle."""
    messages = {
        "ATT": ("If", {"TimeMS": TIME // 1000, "Roll": np.zeros(40)}),
        "GPS": ("IfI", {"TimeMS": TIME[::5] // 1000, "Alt": np.zeros(8), "T": TIME[::5] // 1000 + 7}),
    }
    signals = read(written(tmp_path, dataflash(messages, texts=()))).signals
    np.testing.assert_allclose(signals["ATT.Roll"].time, TIME / 1e6)
    np.testing.assert_allclose(signals["GPS.Alt"].time, TIME[::5] / 1e6 + 0.007)


def test_an_event_without_a_clock_has_the_time_of_the_record_before(tmp_path: Path) -> None:
    timed = dataflash({"ATT": ("If", {"TimeMS": TIME // 1000, "Roll": np.zeros(40)})}, texts=())
    both = dataflash({"ATT": ("If", {"TimeMS": [2000], "Roll": [0.0]}), "EV": ("B", {"Id": [200]})}, texts=())
    head = both[: 3 * 89]  # FMT of FMT, ATT and EV
    event = next(
        both[at : at + 4] for at in range(len(head), len(both)) if both[at : at + 3] == b"\xa3\x95\x8d"
    )
    records = timed[2 * 89 :]
    size = len(records) // 40
    content = head + records[: 10 * size] + event + records[10 * size :]
    assert read(written(tmp_path, content)).signals["EV.Id"].time == pytest.approx([TIME[9] / 1e6])


def test_marks_inside_of_a_record_are_no_record(tmp_path: Path) -> None:
    """0x8D95A3 is two marks and the type of the message itself."""
    values = np.full(40, int.from_bytes(b"\xa3\x95\x8d\x00", "little"), dtype="i8")
    content = dataflash(
        {"AAAA": ("QI", {"TimeUS": TIME, "X": np.arange(40)}), "BBBB": ("QI", {"TimeUS": TIME, "X": values})},
        texts=(),
    )
    signals = read(written(tmp_path, content)).signals
    np.testing.assert_array_equal(signals["BBBB.X"].values, values)
    np.testing.assert_array_equal(signals["AAAA.X"].values, np.arange(40))


def test_garbage_between_records_costs_no_more_than_the_record_before_it(tmp_path: Path) -> None:
    place = CONTENT.index(np.uint64(TIME[20]).tobytes()) - 3
    log = read(written(tmp_path, CONTENT[:place] + b"\x07" * 100 + CONTENT[place:]))
    lost = sum(len(values) for _, columns in MESSAGES.values() for values in list(columns.values())[:1])
    kept = len(log.signals["ATT.Roll"].values) + len(log.signals["GPS.Alt"].values)
    kept += 2 * len(log.signals["IMU.GyrX"].values) + len(log.signals["EV.Id"].values)
    assert lost - 2 <= kept <= lost
    assert "belong to no record" in log.remarks[0]


@pytest.mark.parametrize("content", [b"\xa3\x95", b"\xa3\x95\x80" + bytes(200), CONTENT[89 * 20 :][:300]])
def test_what_is_no_log_is_refused(tmp_path: Path, content: bytes) -> None:
    with pytest.raises(InputError, match="is no DataFlash log"):
        read(written(tmp_path, content))


@settings(max_examples=50)
@given(content=damaged(CONTENT))
def test_damage_gives_a_log_or_one_line(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    assert_a_log_or_one_line(read, tmp_path_factory.getbasetemp() / "damaged.bin", content)


def test_the_records_of_the_real_files_fill_them(shared_data: Path) -> None:
    for path in sorted(shared_data.glob("raw/dataflash_*/*.BIN")):
        log = read(path)
        assert len(log.signals) > 100
        assert all("belong to no record" in remark and int(remark.split()[0]) < 100 for remark in log.remarks)
