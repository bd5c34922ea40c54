"""A log as a person brings it: shown, mapped by a file that can be corrected, and written as a recording."""

import shlex
from pathlib import Path

import numpy as np
import pytest
import yaml

from simgap.platforms import plain_config
from simgap.recordings.recording import read_recording
from simgap.stages.import_ import main as import_log
from simgap.stages.inspect import main as inspect_log


@pytest.fixture
def log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Write a table with names of its own, degrees and milliseconds."""
    monkeypatch.chdir(tmp_path)
    t = np.arange(300) / 100
    columns = np.stack([1000 * t, np.rad2deg(np.sin(t)), np.rad2deg(np.cos(t)), 0 * t + 6], -1)
    np.savetxt("log.csv", columns, delimiter=",", header="A,B,C,D", comments="")
    return Path("log.csv")


MAPPING = """\
kind: joint
t: {from: A, unit: ms}
position: {from: B, unit: deg}
velocity: {from: C, unit: deg/s}
voltage: D
"""


def test_a_log_is_shown_and_a_mapping_written(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        inspect_log([str(log), "--kind", "joint"])
    shown = capsys.readouterr().out
    assert not ended.value.code
    assert all(f"\n{name} " in shown for name in "ABCD")
    assert Path("log.csv.mapping.yaml").read_text().count("kind: joint") == 1


def test_a_recording_needs_no_mapping_and_its_contradictions_are_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    t = np.arange(600) / 100
    columns = np.stack([t, np.sin(t), -np.cos(t), np.cos(t)], -1)
    header = "t,position,velocity,effort,run"
    rows = "\n".join(",".join(f"{value:.6f}" for value in row) + ",one" for row in columns)
    Path("turned.csv").write_text(f"{header}\n{rows}\n")
    with pytest.raises(SystemExit) as ended:
        inspect_log(["turned.csv"])
    shown = capsys.readouterr().out
    assert not ended.value.code
    assert "another sign" in shown
    assert "no mapping" in shown
    assert not list(tmp_path.glob("*.yaml"))


def test_the_command_that_is_shown_can_be_pasted(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log = log.rename("my own log.csv")
    with pytest.raises(SystemExit):
        inspect_log([str(log), "--kind", "joint"])
    command = shlex.split(capsys.readouterr().out.partition("simgap diagnose")[2])
    assert "recording=my own log.csv" in command
    assert all("=" in argument for argument in command)


def test_a_written_mapping_is_never_overwritten(log: Path) -> None:
    for name in ("log.csv.mapping.yaml", "log.csv.mapping-2.yaml"):
        for _ in range(2):  # the same again is no other file
            with pytest.raises(SystemExit):
                inspect_log([str(log), "--kind", "joint"])
        Path("log.csv.mapping.yaml").write_text("mine")
        assert Path(name).exists()
    assert Path("log.csv.mapping.yaml").read_text() == "mine"
    assert {path.name for path in Path().glob("*.yaml")} == {"log.csv.mapping.yaml", "log.csv.mapping-2.yaml"}


def test_a_mapped_log_is_written_as_a_recording(log: Path) -> None:
    Path("mine.yaml").write_text(MAPPING)
    with pytest.raises(SystemExit) as ended:
        import_log([str(log), "--map", "mine.yaml", "-o", "recording.parquet"])
    assert not ended.value.code
    frame = read_recording("recording.parquet").frame
    np.testing.assert_allclose(frame["position"], np.sin(frame["t"]))
    np.testing.assert_allclose(frame["velocity"], np.cos(frame["t"]))


@pytest.mark.parametrize(
    ("output", "said"), [("log.csv", "name says otherwise"), ("log.parquet", "is the log itself")]
)
def test_an_import_never_replaces_the_log(
    log: Path, capsys: pytest.CaptureFixture[str], output: str, said: str
) -> None:
    Path("mine.yaml").write_text(MAPPING)
    with pytest.raises(SystemExit):
        import_log([str(log), "--map", "mine.yaml", "-o", "log.parquet"])
    before = Path(output).read_bytes()
    given = [output] if output.endswith("parquet") else [output, "--map", "mine.yaml"]
    with pytest.raises(SystemExit) as ended:
        import_log([*given, "-o", output])
    assert ended.value.code == 2
    assert said in capsys.readouterr().err
    assert Path(output).read_bytes() == before


def test_a_mapping_that_gives_no_recording_is_not_diagnosed(
    log: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shown = shown_with(MAPPING + "runs: {late: [900, 901]}\n", capsys, "--map", "mine.yaml")
    assert "No diagnosis" in shown
    assert "simgap diagnose" not in shown


def test_a_platform_gives_the_numbers_that_a_mapping_needs(
    log: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A turn of what was logged is so many of the axis, as the platform says."""
    Path("arm.yaml").write_text(
        "inertia: 0.01\nmotor: {resistance: 1, torque_constant: 0.02, gear_ratio: 4}\n"
    )
    Path("mine.yaml").write_text(MAPPING.replace("unit: deg}", "unit: deg, ratio: motor.gear_ratio}"))
    given = [str(log), "--map", "mine.yaml", "platform=arm.yaml", "-o", "recording.parquet"]
    with pytest.raises(SystemExit) as ended:
        import_log(given)
    assert not ended.value.code
    frame = read_recording("recording.parquet").frame
    np.testing.assert_allclose(frame["position"], 4.0 * np.sin(frame["t"]))
    for wrong, said in (
        ("platfrom=arm.yaml", "is not known here"),
        ("joint=elbow", "give platform=FILE, too"),
    ):
        with pytest.raises(SystemExit) as ended:
            import_log([*given[:3], wrong, *given[4:]])
        assert ended.value.code == 2
        assert said in capsys.readouterr().err


def test_a_platform_in_short_forms_gives_the_same_numbers(log: Path) -> None:
    """A motor that is named has a gear ratio and constants, too."""
    Path("arm.yaml").write_text("inertia: 0.01\nmotor: {name: XM430-W350, gear_ratio: 2}\n")
    Path("mine.yaml").write_text(MAPPING.replace("unit: deg}", "unit: deg, ratio: motor.gear_ratio}"))
    with pytest.raises(SystemExit) as ended:
        import_log([str(log), "--map", "mine.yaml", "platform=arm.yaml", "-o", "recording.parquet"])
    assert not ended.value.code
    frame = read_recording("recording.parquet").frame
    turned = plain_config({"kind": "joint", **yaml.safe_load(Path("arm.yaml").read_text())})
    np.testing.assert_allclose(frame["position"], turned["motor"]["gear_ratio"] * np.sin(frame["t"]))


@pytest.mark.parametrize(
    ("kept", "lost", "advice"),
    [
        ("velocity: {from: C, unit: deg/s}", "'position', 'effort'", "it may be {from: B, unit: deg}"),
        ("position: {from: B, unit: deg}", "'effort'", "log what the controller gives"),
    ],
)
def test_an_import_with_a_mapping_that_lacks_columns_names_all_of_them(
    log: Path, capsys, kept, lost, advice
) -> None:
    """The line says which signal it may be, or what the controller has to log, as `simgap inspect --map` does."""
    Path("mine.yaml").write_text(f"kind: joint\nt: {{from: A, unit: ms}}\n{kept}\n")
    with pytest.raises(SystemExit) as ended:
        import_log([str(log), "--map", "mine.yaml", "-o", "recording.parquet"])
    assert ended.value.code == 2
    line = capsys.readouterr().err
    assert f"mine.yaml: has no line for {lost}, which a joint needs; {advice}" in line


def shown_with(mapping: str, capsys: pytest.CaptureFixture[str], *more: str) -> str:
    Path("mine.yaml").write_text(mapping)
    with pytest.raises(SystemExit) as ended:
        inspect_log(["log.csv", *more])
    shown = capsys.readouterr()
    assert not ended.value.code, shown.err
    return shown.out


@pytest.mark.parametrize("option", [["--map", "mine.yaml"], ["mapping=mine.yaml"]])
def test_a_mapping_is_shown_with_what_comes_out(log: Path, option: list[str], capsys) -> None:
    shown = shown_with(MAPPING, capsys, *option)
    assert "as a joint:" in shown
    assert "position             B, in deg  1.00: as mine.yaml says" in shown
    assert "1 run, 300 samples, 3.0 s" in shown
    assert "Nothing in it contradicts itself." in shown
    assert "recording=log.csv mapping=mine.yaml" in shown
    assert [path.name for path in Path().glob("*.yaml")] == ["mine.yaml"]


def test_the_command_that_is_shown_has_the_platform_that_was_given(log: Path, capsys) -> None:
    Path("arm.yaml").write_text("inertia: 0.01\nmotor: {resistance: 1, torque_constant: 0.02}\n")
    shown = shown_with(MAPPING.replace("kind: joint", ""), capsys, "--map", "mine.yaml", "platform=arm.yaml")
    assert "simgap diagnose platform=arm.yaml recording=log.csv mapping=mine.yaml" in shown


def test_a_mapping_that_contradicts_the_log_is_shown_to(log: Path, capsys) -> None:
    shown = shown_with(
        MAPPING.replace("C, unit: deg/s", "C, unit: deg/s, sign: -1"), capsys, "--map", "mine.yaml"
    )
    assert "C · -1, in deg/s" in shown
    assert "Contradiction: " in shown
    assert "another sign" in shown
    assert "contradicts itself." not in shown


def test_what_a_mapping_still_lacks_is_said_for_its_kind(log: Path, capsys) -> None:
    lacking = MAPPING.replace("voltage: D\n", "").replace("from: B", "from: BB")
    shown = shown_with(lacking, capsys, "--map", "mine.yaml")
    assert "effort               missing (needed). Log what the controller gives" in shown
    assert "no signal 'BB'; did you mean 'B'?" in shown
    assert (
        "No diagnosis yet: no signal for 'effort' was found, which a joint needs.\nCorrect mine.yaml."
        in shown
    )
    wrong = shown_with(MAPPING.replace("from: B", "from: BB"), capsys, "--map", "mine.yaml")
    assert "No diagnosis yet: 'position' is not sure.\nCorrect mine.yaml." in wrong


def test_a_signal_that_may_be_what_a_mapping_lacks_is_named(log: Path, capsys) -> None:
    log.write_text(log.read_text().replace("A,B,C,D", "A,pos_deg,vel_dps,coil_V"))
    mapping = "t: {from: A, unit: ms}\nposition: pos_deg\n"
    shown = shown_with(mapping, capsys, "--map", "mine.yaml", "--kind", "joint")
    assert "velocity             missing (better with it). It may be {from: vel_dps, unit: deg/s}" in shown


@pytest.mark.parametrize("command", [inspect_log, lambda given: import_log([*given, "-o", "r.parquet"])])
def test_what_is_not_there_is_one_line(command, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        command(["nothing.ulg"])
    assert ended.value.code == 2
    assert "does not exist" in capsys.readouterr().err
