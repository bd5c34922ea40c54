"""Tables as logs: columns of lists, dates and words; sparse columns; the unit that a name carries."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from simgap.logs.apply import recording_of
from simgap.logs.formats import read_log
from simgap.logs.header_units import quantity_words, unit_in
from simgap.logs.log import Log
from simgap.logs.mapping import mapping_from_config


def log_of(tmp_path: Path, text: str, name: str = "log.csv") -> Log:
    path = tmp_path / name
    path.write_text(text)
    return read_log(path)


@pytest.mark.parametrize(
    ("name", "unit", "rest"),
    [
        ("speed [rad/s]", "rad/s", "speed "),
        ("Velocity (rpm)", "rpm", "Velocity "),
        ("angle_deg", "deg", "angle"),
        ("t_ms", "ms", "t"),
        ("velocity_ms", "m/s", "velocity"),
        ("VelocityRadPerSec", "rad/s", "Velocity"),
        ("MotorRPM", "rpm", "Motor"),
        ("motor_mV", "mV", "motor"),
        ("Current (units)", "units", "Current "),
        ("q[1]", None, "q[1]"),
        ("Position (filtered)", None, "Position (filtered)"),
        ("items", None, "items"),
    ],
)
def test_the_unit_that_a_name_carries(name: str, unit: str | None, rest: str) -> None:
    assert unit_in(name) == unit
    assert quantity_words(name) == rest


def test_lists_dates_and_words(tmp_path: Path) -> None:
    log = log_of(
        tmp_path,
        'stamp,q,state,ok,mixed\n2026-01-02 10:00:00.5,"[0.1, 0.2]",run,true,1\n'
        '2026-01-02 10:00:01.75,"[0.3, 0.4]",run,false,ERR\n2026-01-02T10:00:03,"[0.5, 0.6]",stop,true,3\n',
    )
    np.testing.assert_allclose(log.signals["stamp"].values, [0, 1.25, 2.5])
    assert log.signals["stamp"].unit == "s"
    np.testing.assert_allclose(log.signals["q[1]"].values, [0.2, 0.4, 0.6])
    np.testing.assert_allclose(log.signals["ok"].values, [1, 0, 1])
    assert list(log.texts["state"]) == ["run", "run", "stop"]
    np.testing.assert_array_equal(log.signals["mixed"].time, [0, 2])
    assert "'mixed' has 1 values that are no numbers" in log.remarks[0]


def test_times_of_day(tmp_path: Path) -> None:
    log = log_of(tmp_path, "clock,a\n10:00:59.5,1\n10:01:00.0,2\n10:01:02.25,3\n")
    np.testing.assert_allclose(log.signals["clock"].values, [0, 0.5, 2.75])


def test_columns_of_a_parquet_file_with_dates(tmp_path: Path) -> None:
    path = tmp_path / "log.parquet"
    pd.DataFrame({"when": pd.to_datetime([0, 250], unit="ms"), "x": [1, 2]}).to_parquet(path)
    np.testing.assert_allclose(read_log(path).signals["when"].values, [0, 0.25])


def test_a_sparse_table_of_three_topics(tmp_path: Path) -> None:
    """The angle at 100 Hz, its rate 3 ms later at 50 Hz, and a command in rows of its own at each change."""
    rows = [(k / 100, f"{k / 100:.3f},{np.sin(k / 100):.6f},,") for k in range(301)]
    rows += [(k / 50 + 0.003, f"{k / 50 + 0.003:.3f},,{np.cos(k / 50 + 0.003):.6f},") for k in range(150)]
    rows += [(begin, f"{begin:.3f},,,{value}") for begin, value in ((0.0, 1.0), (1.256, 2.0))]
    text = "time,angle,rate,volts\n" + "\n".join(row for _, row in sorted(rows)) + "\n"
    log = log_of(tmp_path, text)
    assert len(log.signals["volts"].time) == 2
    mapping = mapping_from_config(
        {
            "kind": "joint",
            "t": "time",
            "position": "angle",
            "velocity": "rate",
            "voltage": {"from": "volts", "held": True},
        }
    )
    frame = recording_of(log, mapping).frame
    time = frame["t"].to_numpy() + 0.003
    np.testing.assert_allclose(np.diff(time), 0.02, atol=1e-9)
    np.testing.assert_allclose(frame["position"], np.sin(time), atol=1e-3)
    np.testing.assert_allclose(frame["velocity"], np.cos(time), atol=1e-5)
    # 1 V until 1.256 s and 2 V after; over the step of the change its mean
    last = int(np.searchsorted(time, 1.256)) - 1
    np.testing.assert_allclose(frame["voltage"][:last], 1.0)
    np.testing.assert_allclose(frame["voltage"][last + 1 :], 2.0)
    assert frame["voltage"][last] == pytest.approx(1 + (time[last] + 0.02 - 1.256) / 0.02, abs=0.02)


def test_a_long_table_of_names_and_values(tmp_path: Path) -> None:
    rows = "".join(f'{k / 50},"/arm/positionRad",{k}\n{k / 50},"/arm/enabled",true\n' for k in range(4))
    log = log_of(tmp_path, f"Timestamp,Key,Value\n{rows}9,/arm/name,elbow\n")
    np.testing.assert_array_equal(log.signals["/arm/positionRad"].values, range(4))
    np.testing.assert_array_equal(log.signals["/arm/positionRad"].time, [0, 2, 4, 6])
    np.testing.assert_array_equal(log.signals["/arm/enabled"].values, 1)
    assert set(log.signals) == {"Timestamp", "/arm/positionRad", "/arm/enabled"}


def test_seconds_and_nanoseconds_are_one_time(tmp_path: Path) -> None:
    log = log_of(tmp_path, "h.stamp.sec,h.stamp.nanosec,q\n1700000000,900000000,1\n1700000001,150000000,2\n")
    np.testing.assert_allclose(log.signals["h.stamp"].values, [0.9, 1.15])


def test_a_header_behind_a_sign_of_comment(tmp_path: Path) -> None:
    log = log_of(tmp_path, "%time,field.q\n1700000000000000000,1\n1700000000020000000,2\n")
    np.testing.assert_array_equal(log.signals["field.q"].values, [1, 2])
