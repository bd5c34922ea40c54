"""ULog: what was written is read, as pyulog reads it; damage costs what it hits."""

import struct
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyulog import ULog

from simgap.errors import InputError
from simgap.logs.formats import format_of, read_log
from simgap.logs.readers.ulog import read
from tests.pipeline.logs.damage import assert_a_log_or_one_line, damaged
from tests.pipeline.logs.ulog_encoder import info, message, ulog

TIME = 1_000_000 + 1000 * np.arange(60)
TOPICS = {
    "battery": {"timestamp": TIME[::10], "volts": np.linspace(12, 11, 6).astype("f4")},
    "battery[1]": {"timestamp": TIME[::20], "volts": np.linspace(5, 4, 3).astype("f4")},
    "motion": {
        "timestamp": TIME,
        "q": np.random.default_rng(0).normal(size=(60, 4)).astype("f4"),
        "count": np.arange(60, dtype="i4"),
        "armed": np.arange(60) % 2 == 0,
    },
}
CONTENT = ulog(TOPICS, {"SYS_AUTOSTART": 4001, "PWM_MIN": 1075, "THR_MDL_FAC": 0.5, "RC_MAP": 3})


def written(folder: Path, content: bytes) -> Path:
    path = folder / "log.ulg"
    path.write_bytes(content)
    return path


def test_topics_instances_and_elements_are_signals(tmp_path: Path) -> None:
    path = written(tmp_path, CONTENT)
    assert format_of(path).name == "PX4 ULog"
    signals = read_log(path).signals
    assert set(signals) == {
        "battery.volts", "battery[1].volts", "motion.count", "motion.armed", *(f"motion.q[{k}]" for k in range(4))
    }  # fmt: skip
    np.testing.assert_array_equal(signals["motion.q[2]"].values, TOPICS["motion"]["q"][:, 2])
    np.testing.assert_allclose(signals["battery[1].volts"].time, [0.0, 0.02, 0.04])
    assert signals["motion.armed"].held
    assert not signals["motion.count"].held


def test_what_concerns_the_motors_is_told(tmp_path: Path) -> None:
    facts = read(written(tmp_path, CONTENT)).facts
    assert facts == {"software": "PX4", "PWM_MIN": "1075", "SYS_AUTOSTART": "4001", "THR_MDL_FAC": "0.5"}


def test_what_was_logged_before_the_log_began_is_before_zero(tmp_path: Path) -> None:
    late = read(written(tmp_path, ulog(TOPICS, start=1_030_000)))
    assert late.signals["motion.count"].time[0] == pytest.approx(-0.03)


def test_an_appended_section_is_read_and_what_was_cut_is_not(tmp_path: Path) -> None:
    whole, cut = (
        read(written(tmp_path, CONTENT)).signals,
        read(written(tmp_path, ulog(TOPICS, cut_at=40))).signals,
    )
    for name, signal in whole.items():
        np.testing.assert_array_equal(cut[name].values, signal.values)


def test_lost_data_is_told(tmp_path: Path) -> None:
    log = read(written(tmp_path, ulog(TOPICS, dropouts={10: 30, 20: 70})))
    assert log.remarks == ("The logger lost data 2 times, 0.1 s in all; the gaps are kept.",)


def test_after_damage_it_goes_on_at_the_next_mark(tmp_path: Path) -> None:
    place = CONTENT.index(struct.pack("<Q", int(TIME[5]))) - 5
    log = read(written(tmp_path, CONTENT[:place] + b"\0" * 7 + CONTENT[place + 3 :]))
    counts = log.signals["motion.count"].values
    assert counts[0] == 0
    assert counts[-1] == 59
    assert 0 < len(counts) < 60
    assert any("damaged" in remark for remark in log.remarks)


def test_a_file_that_was_cut_off_has_what_is_there(tmp_path: Path) -> None:
    log = read(written(tmp_path, CONTENT[:-100]))
    counts = log.signals["motion.count"].values
    np.testing.assert_array_equal(counts, np.arange(len(counts)))
    assert 50 < len(counts) < 60
    assert log.remarks == ()


def _defining(text: str, records: int = 5) -> bytes:
    head = b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0) + message("B", bytes(40))
    body = (
        message("F", text.encode()) + message("F", b"b:a x;") + message("A", struct.pack("<BH", 0, 1) + b"a")
    )
    return head + body + records * message("D", struct.pack("<HQ", 1, 0))


@pytest.mark.parametrize(
    "text",
    [
        "a:uint64_t timestamp;a inner;",
        "a:uint64_t timestamp;b inner;",
        "a:uint64_t timestamp;uint8_t[65535] x;",
        "a:uint64_t timestamp;uint8_t[99999999999] x;",
        "a:uint64_t timestamp;float y;",
        "a:unknown timestamp;",
        "a:uint64_t timestamp;uint8_t x;uint8_t x;",
    ],
)
def test_a_format_that_cannot_be_is_left_out(tmp_path: Path, text: str) -> None:
    assert_a_log_or_one_line(read, tmp_path / "log.ulg", _defining(text))
    assert len(read(written(tmp_path, _defining(text))).signals) == 0


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"ULog\x01\x12\x34" + bytes(20), "is no ULog"),
        (CONTENT[:12], "is no ULog"),
        (CONTENT[:28] + b"\x01" + CONTENT[29:], "cannot be read"),  # a flag of a newer version
    ],
)
def test_what_is_no_log_is_refused(tmp_path: Path, content: bytes, said: str) -> None:
    with pytest.raises(InputError, match=said):
        read(written(tmp_path, content))


@settings(max_examples=50)
@given(content=damaged(CONTENT + info("char[4] ver_hw", b"TEST", "I")))
def test_damage_gives_a_log_or_one_line(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    assert_a_log_or_one_line(read, tmp_path_factory.getbasetemp() / "damaged.ulg", content)


@settings(max_examples=10)
@given(values=st.lists(st.floats(width=32), min_size=1, max_size=20))
def test_any_values_come_back(tmp_path_factory: pytest.TempPathFactory, values: list[float]) -> None:
    topic = {"timestamp": TIME[: len(values)], "x": np.array(values, dtype="f4")}
    log = read(written(tmp_path_factory.getbasetemp(), ulog({"t": topic})))
    np.testing.assert_array_equal(log.signals["t.x"].values, np.array(values, dtype="f4"))


def test_the_real_files_are_read_as_pyulog_reads_them(shared_data: Path) -> None:
    for path in sorted(shared_data.glob("raw/ulog_*/*.ulg")):
        log, reference = read(path), ULog(str(path))
        compared = 0
        for topic in reference.data_list:
            prefix = topic.name + (f"[{topic.multi_id}]" if topic.multi_id else "")
            for field, values in topic.data.items():
                if f"{prefix}.{field}" in log.signals:
                    np.testing.assert_array_equal(log.signals[f"{prefix}.{field}"].values, values)
                    compared += 1
        assert compared == len(log.signals) > 200
