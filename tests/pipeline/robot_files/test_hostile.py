"""Robot files of a stranger: refused in one line, and nothing is read from elsewhere."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from simgap.errors import InputError
from simgap.robot_files import read_robot_file
from tests.pipeline.robot_files.robots import mjcf, rod

LAUGHS = (
    "<!DOCTYPE robot [<!ENTITY a 'ha'>"
    + "".join(f"<!ENTITY {chr(98 + i)} '{f'&{chr(97 + i)};' * 10}'>" for i in range(12))
    + "]><robot name='&m;'/>"
)
ELSEWHERE = (
    '<!DOCTYPE robot [<!ENTITY x SYSTEM "file:///etc/passwd">]><robot name="r"><link name="&x;"/></robot>'
)
PARAMETER = '<!DOCTYPE robot [<!ENTITY % x SYSTEM "http://localhost/x.dtd"> %x;]><robot/>'


@pytest.mark.parametrize(
    ("content", "line"),
    [
        (LAUGHS.encode(), "declares a document type"),
        (ELSEWHERE.encode(), "declares a document type"),
        (PARAMETER.encode(), "declares a document type"),
        (b"<?xml version='1.0'?>\n<!--c-->\n" + ELSEWHERE.encode(), "declares a document type"),
        (ELSEWHERE.encode("utf-16"), "is not UTF-8"),
        (b"<?xml version='1.0' encoding='utf-7'?>+ADw-!DOCTYPE robot+AD4-", "is not XML"),
        (b"<robot>" * 200 + b"</robot>" * 200, "nested deeper than 100"),
        (b"<robot>" + b"<a/>" * (1 << 20) + b"</robot>", "is larger than 4 MB"),
        (b"<robot>&undefined;</robot>", "is not XML"),
        (b"<robot", "is not XML"),
        (b"", "is not XML"),
        (b"\x00\x01\x02", "is not XML"),
        (b"solid cube", "is not XML"),
    ],
    ids=["laughs", "external", "parameter", "later", "utf-16", "utf-7", "deep", "large", "entity", "cut", "empty",
         "binary", "stl"],
)  # fmt: skip
def test_a_hostile_file_is_refused_in_one_line(content, line, tmp_path):
    (tmp_path / "robot.urdf").write_bytes(content)
    with pytest.raises(InputError) as refused:
        read_robot_file(tmp_path / "robot.urdf")
    assert line in str(refused.value)
    assert "\n" not in str(refused.value)
    assert "root:" not in str(refused.value)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_robot_file(tmp_path / "absent.urdf")
    with pytest.raises(InputError, match="cannot be read"):
        read_robot_file(tmp_path)


def test_a_long_chain_of_links_is_no_trouble(tmp_path):
    count = 1200  # more than Python may call functions in one another
    links = "".join(
        f'<link name="l{i}"><inertial><origin xyz="0.01 0 0"/><mass value="1"/></inertial></link>'
        for i in range(count)
    )
    joints = "".join(
        f'<joint name="j{i}" type="{"continuous" if i == 1 else "fixed"}"><parent link="l{i - 1}"/>'
        f'<child link="l{i}"/><axis xyz="0 0 1"/></joint>'
        for i in range(1, count)
    )
    (tmp_path / "chain.urdf").write_text(f"<robot>{links}{joints}</robot>")
    assert read_robot_file(tmp_path / "chain.urdf")["inertia"] == pytest.approx((count - 1) * 1e-4)


def answer(path: Path) -> bool:
    """Whether a file is read as a joint with an inertia, or refused in one line."""
    try:
        return read_robot_file(path)["inertia"] > 0.0
    except InputError as refused:
        return "\n" not in str(refused)


@pytest.mark.parametrize(
    "text",
    [
        rod(rpy="0 0.3 0", effort=2.0),
        mjcf('<body><joint axis="0 1 0"/><geom type="box" size="0.1 0.1 0.1" euler="0.1 0.2 0.3"/></body>'),
    ],
    ids=["urdf", "mjcf"],
)
@given(data=st.data())
def test_a_damaged_file_is_read_or_refused(text, data, tmp_path_factory):
    """Bytes changed, cut or doubled: never anything but an answer or one line."""
    content = bytearray(text.encode())
    for _ in range(data.draw(st.integers(1, 4))):
        at = data.draw(st.integers(0, len(content) - 1))
        content[at : at + data.draw(st.integers(0, 3))] = data.draw(st.binary(max_size=3))
        if not content:
            return
    path = tmp_path_factory.mktemp("damaged") / "robot.xml"
    path.write_bytes(bytes(content))
    assert answer(path)
