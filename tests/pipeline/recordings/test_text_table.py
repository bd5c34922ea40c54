"""Tables as people export them: separators, decimal signs, encodings, units, comments, damaged rows."""

import contextlib
import gzip
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.recordings.storage import header_of, read_table

PLAIN = "t,angle,speed\n0,1.5,-2\n0.1,2.5,3e-1\n"
EXPECTED = {"t": [0, 0.1], "angle": [1.5, 2.5], "speed": [-2, 0.3]}


def read(tmp_path: Path, text: str | bytes, name: str = "log.csv"):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_table(path)


def assert_plain(table) -> None:
    assert list(table.frame) == list(EXPECTED)
    for name, values in EXPECTED.items():
        np.testing.assert_allclose(table.frame[name].to_numpy(), values)


@pytest.mark.parametrize(
    "text",
    [
        PLAIN,
        PLAIN.replace(",", "\t"),
        PLAIN.replace(",", ";"),
        PLAIN.replace(",", ";").replace(".", ","),
        PLAIN.replace(",", "|"),
        PLAIN.replace(",", "   "),
        PLAIN.replace(",", " , "),
        PLAIN.replace("\n", "\r\n"),
        PLAIN.replace("\n", ",\n"),
        PLAIN.removesuffix("\n"),
        "\ufeff" + PLAIN,
        "# robot 7\n# 3 March\n" + PLAIN,
        "% made by a script\n\n" + PLAIN,
        "# " + PLAIN,
        "Device: arm\nFirmware: 1.2\n" + PLAIN,
        PLAIN.replace("0.1,", "# a remark\n0.1,"),
        't,angle,speed\n"0","1.5","-2"\n"0.1","2.5","0.3"\n',
        '"t","angle","speed"\n0,"1.5",-2\n0.1,2.5,0.3\n',
        "t,angle,speed,\n0,1.5,-2,\n0.1,2.5,0.3,\n",
        ",t,angle,speed\n0,0,1.5,-2\n1,0.1,2.5,0.3\n",
    ],
)
def test_one_table_written_in_many_ways(tmp_path: Path, text: str) -> None:
    assert_plain(read(tmp_path, text))


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
def test_encodings_with_a_mark(tmp_path: Path, encoding: str) -> None:
    text = PLAIN if encoding in ("utf-8-sig", "utf-16") else "\ufeff" + PLAIN
    assert_plain(read(tmp_path, text.encode(encoding)))


def test_western_code_page_and_gzip(tmp_path: Path) -> None:
    table = read(tmp_path, "t,Winkel [°]\n0,1\n1,2\n".encode("latin-1"))
    assert list(table.frame) == ["t", "Winkel [°]"]
    packed = gzip.compress(PLAIN.encode())
    assert_plain(read(tmp_path, packed, "log.csv.gz"))
    assert_plain(read(tmp_path, packed, "log.csv"))
    with pytest.raises(InputError, match="undamaged"):
        read(tmp_path, packed[: len(packed) // 2], "log.csv.gz")


def test_what_unpacks_to_far_more_than_a_table_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("simgap.recordings.packed._SMALL", 1 << 10)
    bomb = gzip.compress(b"t,x\n" + b"0,0\n" * (1 << 20), compresslevel=9)
    with pytest.raises(InputError, match="unpacks to more"):
        read(tmp_path, bomb, "log.csv.gz")


@pytest.mark.parametrize("row", ["s,deg,rad/s", "[s],[deg],[rad/s]", "(s),(deg),(rad/s)"])
def test_a_row_of_units(tmp_path: Path, row: str) -> None:
    table = read(tmp_path, PLAIN.replace("\n", f"\n{row}\n", 1))
    assert_plain(table)
    assert table.units == {"t": "s", "angle": "deg", "speed": "rad/s"}


@pytest.mark.parametrize("empty", ["", " ", "nan", "NaN", "null", "NULL", "None", "-", "#N/A", "-nan(ind)"])
def test_what_stands_for_no_value(tmp_path: Path, empty: str) -> None:
    frame = read(tmp_path, f"t,a,b\n0,1,2\n1,{empty},3\n").frame
    np.testing.assert_array_equal(frame["a"].to_numpy(), [1, np.nan])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ('t,a\n0,"1,234.5"\n1,"12,345,678"\n', [1234.5, 12345678]),
        ("t;a\n0;1.234,5\n1;2,5\n", [1234.5, 2.5]),
        ('t,a\n0.5,"1,234"\n1,2\n', [1234, 2]),
        ('t;a\n0,5;"1,234"\n1;2\n', [1.234, 2]),
    ],
)
def test_thousands_where_they_can_be_nothing_else(tmp_path: Path, text: str, value: list[float]) -> None:
    np.testing.assert_allclose(read(tmp_path, text).frame["a"], value)


def test_a_comma_that_may_be_both_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="may be a fraction or thousands"):
        read(tmp_path, "t;a\n1;1,234\n2;2,345\n")


def test_flags_text_and_numbers_behind_the_first_block(tmp_path: Path) -> None:
    rows = "".join(f"{k},1,True,run{k // 50000}\n" for k in range(100_000))
    frame = read(tmp_path, f"t,n,enabled,run\n{rows}100000,1.5,False,end\n").frame
    assert frame["n"].iloc[-1] == 1.5
    assert frame["enabled"].dtype == bool
    assert frame["run"].iloc[-1] == "end"


def test_one_word_makes_a_column_text_so_that_it_can_be_named(tmp_path: Path) -> None:
    frame = read(tmp_path, "t,a\n0,1\n1,2\n" + "2,3\n" * 300 + "3,fast\n").frame
    assert frame["a"].iloc[-1] == "fast"
    assert frame["a"].iloc[0] == "1"


def test_rows_cut_off_are_left_out_and_told(tmp_path: Path) -> None:
    table = read(tmp_path, PLAIN + "0.2,3.5\n")
    assert_plain(table)
    assert "1 row has fewer values than the header (line 4)" in table.remarks[0]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0,1\n1,2\n", "has no row of names"),
        ("a,b\n0,1,2\n1,2,3\n", "more columns than the header"),
        ("a,b\n0,1\n1,2\n3,4,5\n", "line 4 has 3 values instead of 2"),
        ("a,b,c\n0,1,2\n1,2\n2,3\n3,4,5\n", "fewer values than the header"),
        ("a,a\n0,1\n", "appears twice"),
    ],
)
def test_what_is_no_table_is_refused_in_one_line(tmp_path: Path, text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        read(tmp_path, text)
    assert "\n" not in str(caught.value)


def test_a_workbook_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="save the sheet as CSV"):
        read(tmp_path, b"PK\x03\x04 not a table", "log.xlsx")


def test_names_alone_are_read_without_the_rows(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_text("# made\nt;a [deg]\n0;1,5\n")
    assert header_of(path) == ["t", "a [deg]"]


@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(position=st.integers(0, 400), value=st.integers(0, 255), end=st.integers(1, 400), packed=st.booleans())
def test_damage_is_told_in_one_line(
    tmp_path: Path, position: int, value: int, end: int, packed: bool
) -> None:
    content = (
        ("t;a\n" + "".join(f"{k / 10:.1f};{k * 1.5:.3f}\n" for k in range(40))).replace(".", ",").encode()
    )
    content = bytearray(gzip.compress(content, mtime=0) if packed else content)
    content[position % len(content)] = value
    with contextlib.suppress(InputError):  # anything else fails
        assert len(read(tmp_path, bytes(content[: max(end % len(content), 1)])).frame) <= 60
