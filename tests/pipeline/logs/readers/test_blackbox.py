"""Blackbox logs: encodings, predictors, damaged frames, several logs in one file, and real ones."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.logs.formats import read_log
from simgap.logs.log import Log
from tests.pipeline.logs.readers import blackbox_writer as writer
from tests.pipeline.logs.readers.blackbox_writer import END, Field, encoded, frames, header

FACTS = {
    "Firmware revision": "Betaflight 4.3.1 (abc) STM32F745",
    "I interval": 64,
    "P interval": 8,
    "gyro_scale": "0x3f800000",
    "acc_1G": 2048,
    "minthrottle": 1070,
    "vbatref": 1650,
    "motorOutput": "158,2047",
}
CLOCK = (
    Field("loopIteration", False, (0, writer.UNSIGNED), (6, writer.NULL)),
    Field("time", False, (0, writer.UNSIGNED), (2, writer.SIGNED)),
)
FIELDS = (
    *CLOCK,
    Field("axisP[0]", between=(1, writer.TAG2_3S32)),
    Field("axisP[1]", between=(1, writer.TAG2_3S32)),
    Field("axisP[2]", between=(1, writer.TAG2_3S32)),
    *(Field(f"rcCommand[{place}]", between=(1, writer.TAG8_4S16)) for place in range(4)),
    Field("vbatLatest", False, (9, writer.NEGATIVE), (1, writer.TAG8_8SVB)),
    Field("rssi", False, (0, writer.UNSIGNED), (1, writer.TAG8_8SVB)),
    *(Field(f"gyroADC[{axis}]", between=(3, writer.SIGNED)) for axis in range(3)),
    *(Field(f"debug[{place}]", between=(1, writer.TAG2_3SVARIABLE)) for place in range(3)),
    Field("servo[5]", key=(8, writer.SIGNED)),
    Field("motor[0]", False, (11, writer.UNSIGNED), (3, writer.SIGNED)),
    Field("motor[1]", False, (5, writer.SIGNED), (3, writer.SIGNED)),
)


def some_rows(samples: int, seed: int = 0, step: int = 1000) -> np.ndarray:
    """Return rows of `FIELDS` with small and great changes."""
    random = np.random.default_rng(seed)
    rows = np.zeros((samples, len(FIELDS)), dtype=np.int64)
    rows[:, 0], rows[:, 1] = 8 * np.arange(samples), 5_000_000 + step * np.arange(samples)
    sizes = random.choice([1, 6, 30, 120, 3000], (samples, len(FIELDS)))
    rows[:, 2:] = np.rint(sizes * random.standard_normal(sizes.shape))[:, 2:]
    rows[:, 9] = 1600 + rows[:, 9] % 90
    rows[:, 10] = rows[:, 10] % 1000
    rows[:, -3:] = 1500 + rows[:, -3:] % 500
    return rows


def written(rows: np.ndarray, facts: dict = FACTS, fields: tuple[Field, ...] = FIELDS) -> bytes:
    return header(fields, facts) + b"".join(frames(fields, rows, facts, every=8)) + END


def read(folder: Path, content: bytes, name: str = "log.bbl") -> Log:
    path = folder / name
    path.write_bytes(content)
    return read_log(path)


def assert_rows(log: Log, rows: np.ndarray) -> None:
    """Assert that a log holds rows of `FIELDS`, in the units that its header gives."""
    for place, field in enumerate(FIELDS[2:], 2):
        scale = 0.01 if field.name == "vbatLatest" else 1.0
        np.testing.assert_allclose(log.signals[field.name].values, scale * rows[:, place], err_msg=field.name)


def test_the_writer_writes_what_the_format_documents():
    assert [writer.unsigned(value) for value in (42, 128, 23456)] == [b"\x2a", b"\x80\x01", b"\xa0\xb7\x01"]
    assert [writer.signed(value) for value in (0, -1, 1, -2)] == [b"\x00", b"\x01", b"\x02", b"\x03"]
    assert writer.eight([0, 0, 4, 0, 8]) == bytes([0b00010100, 8, 16])
    assert writer.four([13, 0, 4, 2]) == bytes([0b01010010, 0x0D, 0x42])
    assert encoded([205, 1, -1, 42], [writer.SIGNED] * 4) == bytes([0x9A, 0x03, 0x02, 0x01, 0x54])


def test_every_encoding_and_predictor_is_undone(tmp_path):
    rows = some_rows(200)
    log = read(tmp_path, written(rows))
    assert_rows(log, rows)
    assert log.remarks == ()
    np.testing.assert_allclose(log.signals["axisP[0]"].time, 1e-3 * np.arange(200), atol=1e-12)
    assert [(span.begin, round(span.end, 6)) for span in log.spans] == [(0.0, 0.199)]


@settings(max_examples=20)
@given(
    values=st.lists(
        st.lists(st.integers(-(2**31), 2**31 - 1), min_size=3, max_size=3), min_size=2, max_size=9
    )
)
def test_numbers_of_32_bits_survive(tmp_path_factory, values):
    fields = (*CLOCK, *(Field(f"debug[{place}]", between=(2, writer.TAG2_3S32)) for place in range(3)))
    small = np.array(values) // 8  # so that what a straight line misses fits into 32 bits
    clock = np.column_stack([8 * np.arange(len(small)), 1000 * np.arange(len(small))])
    log = read(tmp_path_factory.mktemp("log"), written(np.hstack([clock, small]), FACTS, fields))
    for place in range(3):
        assert log.signals[f"debug[{place}]"].values.tolist() == small[:, place].tolist()


@pytest.mark.parametrize("name", ["LOG00353.TXT", "flash.bfl", "LOG.BBS"])
def test_a_log_is_known_by_its_first_line_or_its_name(tmp_path, name):
    rows = some_rows(20)
    assert_rows(read(tmp_path, written(rows), name), rows)


def test_a_clock_that_turns_over_goes_on(tmp_path):
    rows = some_rows(100)
    rows[:, 1] = 2**32 - 50_000 + 1000 * np.arange(100)
    rows[:, 1] %= 2**32
    time = read(tmp_path, written(rows)).signals["rssi"].time
    np.testing.assert_allclose(time, 1e-3 * np.arange(100), atol=1e-9)


def test_damage_costs_the_frames_up_to_the_next_key_frame(tmp_path):
    rows = some_rows(80)
    pieces = frames(FIELDS, rows, FACTS, every=8)
    pieces[18] = pieces[18][:4] + pieces[18][7:]  # bytes that the recorder has dropped
    log = read(tmp_path, header(FIELDS, FACTS) + b"".join(pieces) + END)
    lost = np.arange(18, 24)
    kept = np.round(log.signals["rssi"].time * 1e3).astype(int)
    assert set(np.setdiff1d(np.arange(80), kept)) <= set(lost)
    assert not set(kept) & {18, 19}
    whole = np.setdiff1d(kept, lost)
    place = np.isin(kept, whole)
    np.testing.assert_allclose(log.signals["axisP[1]"].values[place], rows[whole, 3])
    assert any("damaged at 1 place" in remark for remark in log.remarks)


def test_logs_of_one_file_lie_one_behind_the_other(tmp_path):
    first, second = some_rows(30, seed=1), some_rows(50, seed=2)
    content = written(first) + b"\xff" * 300 + header(FIELDS, FACTS) + END + b"junk" + written(second)
    log = read(tmp_path, content)
    assert [span.name for span in log.spans] == ["log 1", "log 3"]
    assert log.spans[0].end < log.spans[1].begin
    assert any("1 of 3 logs hold no frames" in remark for remark in log.remarks)
    assert_rows(log, np.concatenate([first, second]))
    assert (np.diff(log.signals["rssi"].time) > 0).all()


def test_frames_on_change_are_held(tmp_path):
    slow = "H Field S name:flightModeFlags,stateFlags\nH Field S signed:0,0\nH Field S predictor:0,0\n"
    rows = some_rows(40)
    pieces = frames(FIELDS, rows, FACTS, every=8)
    pieces.insert(20, b"S" + writer.unsigned(1) + writer.unsigned(3))
    pieces.insert(10, b"S" + writer.unsigned(0) + writer.unsigned(3))
    pieces.insert(25, b"E" + bytes([30]) + writer.unsigned(5) + writer.unsigned(300))
    head = header(FIELDS, FACTS) + slow.encode() + b"H Field S encoding:1,1\n"
    log = read(tmp_path, head + b"".join(pieces) + END)
    flags = log.signals["flightModeFlags"]
    assert flags.held
    assert flags.values.tolist() == [0.0, 1.0]
    np.testing.assert_allclose(flags.time, [0.009, 0.019])
    assert_rows(log, rows)


@pytest.mark.parametrize(
    ("facts", "name", "raw", "value", "unit"),
    [
        ({}, "gyroADC[0]", 90, 90.0, "deg/s"),
        ({"blackbox_high_resolution": 1}, "gyroADC[0]", 905, 90.5, "deg/s"),
        ({"gyro_scale": "0x3089705f"}, "gyroADC[0]", 100, 100 * 1e-9 * 1e6, "rad/s"),
        ({}, "accSmooth[2]", 2048, 1.0, "g"),
        ({"acc_1G": 4096}, "accSmooth[2]", 2048, 0.5, "g"),
        ({}, "vbatLatest", 1650, 16.5, "V"),
        ({"Firmware revision": "INAV 7.1.0 (x) F7"}, "vbatLatest", 1650, 16.5, "V"),
        ({"Firmware revision": "Cleanflight 1.9.0"}, "vbatLatest", 1650, 1650.0, None),
        ({}, "setpoint[0]", -200, -200.0, "deg/s"),
        ({}, "setpoint[3]", 350, 350.0, None),
        ({}, "eRPM[0]", 321, 32100.0, None),
    ],
)
def test_units_are_those_of_the_header(tmp_path, facts, name, raw, value, unit):
    rows = np.column_stack([8 * np.arange(9), 1000 * np.arange(9), np.full(9, raw)])
    signal = read(tmp_path, written(rows, FACTS | facts, (*CLOCK, Field(name)))).signals[name]
    assert signal.values[0] == pytest.approx(value, rel=1e-3)
    assert signal.unit == unit


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"not a log at all", "holds no blackbox log"),
        (writer.START, "has no frames"),
        (header(FIELDS, FACTS), "has no frames"),
        (header(FIELDS, FACTS).replace(b"P encoding:9", b"P encoding:77"), "has no frames"),
    ],
)
def test_a_file_without_frames_is_refused(tmp_path, content, said):
    with pytest.raises(InputError, match=said):
        read(tmp_path, content)


@settings(max_examples=40)
@given(
    flips=st.lists(st.tuples(st.floats(0, 1), st.integers(0, 7)), max_size=12),
    kept=st.floats(0.05, 1.0),
)
def test_any_damage_gives_a_log_or_a_plain_refusal(tmp_path_factory, flips, kept):
    content = bytearray(written(some_rows(60)))
    for place, bit in flips:
        content[min(int(place * len(content)), len(content) - 1)] ^= 1 << bit
    try:
        log = read(tmp_path_factory.mktemp("log"), bytes(content[: int(kept * len(content))]))
    except InputError:
        return
    for signal in log.signals.values():
        assert len(signal.time) == len(signal.values)
        assert (np.diff(signal.time) >= 0).all()


def test_a_header_without_bits_to_read_takes_no_memory(tmp_path):
    """Fields that cost nothing could make a file of a megabyte fill a gigabyte."""
    nothing = (*CLOCK[:1], Field("time", False, (0, writer.UNSIGNED), (6, writer.NULL)))
    fields = (*nothing, *(Field(f"debug[{place}]", between=(1, writer.NULL)) for place in range(100)))
    rows = np.zeros((2, len(fields)), dtype=np.int64)
    log = read(tmp_path, header(fields, FACTS) + frames(fields, rows, FACTS, 8)[0] + b"P" * 100_000)
    values = sum(len(signal.values) for signal in log.signals.values())
    assert values <= 9 * 100_300


def test_real_logs(shared_data):
    folder = shared_data / "raw" / "blackbox_fc_blackbox"
    whole = read_log(folder / "btfl_all.bbl")
    assert [span.name for span in whole.spans] == [f"log {n}" for n in (1, 4, 12, 16, 28, 33, 35)]
    assert any("37 of 44 logs" in remark for remark in whole.remarks)
    sagging = read_log(folder / "LOG00037.BFL")
    battery, current = sagging.signals["vbatLatest"], sagging.signals["amperageLatest"]
    assert 17.0 < battery.values.min() < 18.0
    assert 22.5 < battery.values.max() < 23.0
    assert current.values.max() == pytest.approx(119.78)
    assert np.corrcoef(battery.values, current.values)[0, 1] < -0.7
    calm = read_log(folder / "btfl_002.bbl")
    assert len(calm.signals["gyroADC[0]"].values) == 66640
    assert np.median(np.diff(calm.signals["gyroADC[0]"].time)) == pytest.approx(0.002)
