"""The command line of a stage as a person meets it."""

import json
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

from simgap.runner.command import run_command

UNTRACKED = "tracking.enabled=false"

Command = Callable[..., tuple[int, str, str]]


@pytest.fixture
def command(tiny: ModuleType, capfd: pytest.CaptureFixture[str]) -> Command:
    def call(*arguments: str) -> tuple[int, str, str]:
        code = run_command(tiny.tiny_stage, [*arguments, UNTRACKED])
        return code, *capfd.readouterr()

    return call


def files(folder: str = ".") -> list[str]:
    return sorted(str(path) for path in Path(folder).rglob("*") if path.is_file())


def test_a_stage_writes_below_the_working_directory_and_says_where(command: Command) -> None:
    code, out, err = command("name=trial")
    assert (code, out, err) == (0, "tiny_stage: wrote artifacts/trial/tiny_stage\n", "")
    assert files() == ["artifacts/trial/tiny_stage/draws", "artifacts/trial/tiny_stage/metrics.json"]


def test_metrics_are_written_as_valid_json(command: Command) -> None:
    command("output=out")
    metrics = json.loads(Path("out/metrics.json").read_text())
    assert metrics["undefined"] is None
    assert metrics["sum"] == pytest.approx(sum(json.loads(Path("out/draws").read_text())))


def test_twins_write_the_same_bytes_and_another_seed_does_not(command: Command) -> None:
    for seed, output in [(1, "first"), (1, "second"), (2, "other")]:
        assert command(f"seed={seed}", f"output={output}")[0] == 0
    assert Path("first/draws").read_bytes() == Path("second/draws").read_bytes()
    assert Path("first/draws").read_bytes() != Path("other/draws").read_bytes()


MISTAKES = [
    ("sed=1", "sed=1: unknown key 'sed'; did you mean 'seed'?"),
    ("seed=x", "seed: Value 'x' of type 'str' could not be converted to Integer; correct the value"),
    ("drawing.amont=1", "drawing: unknown key 'amont'; did you mean 'amount'?"),
    ("+drawing.amont=1", "drawing: unknown key 'amont'; did you mean 'amount'?"),
    (
        "drawing.scale=wide",
        "drawing.scale: Value 'wide' of type 'str' could not be converted",
    ),
    ("drawing=none", "drawing: there is no 'none'; use one of default"),
    ("platform=sparow", "platform: there is no 'sparow'; did you mean 'sparrow'?"),
    ("seed", "seed: is not of the form key=value; see --help"),
    ("seed=[1", "seed=[1: "),
    ("--sed=1", "--sed=1: unknown flag; see --help"),
    ("seed=${absent}", "seed: Interpolation key 'absent' not found"),
    ("drawing.amount=-1", "drawing.amount: must not be negative; give another one"),
    ("recording=absent.csv", "absent.csv: does not exist; check the path"),
    ("artifacts=/proc/absent", "/proc/absent/tiny_stage: cannot be written"),
]


@pytest.mark.parametrize(("override", "line"), MISTAKES, ids=[entry[0] for entry in MISTAKES])
def test_a_mistake_is_one_line_and_exit_code_2(command: Command, override: str, line: str) -> None:
    code, out, err = command(override)
    assert (code, out) == (2, "")
    assert err.startswith(f"simgap tiny_stage: {line}")
    assert err.count("\n") == 1
    assert files() == []


def test_debug_shows_where_a_mistake_was_found(command: Command) -> None:
    code, _, err = command("drawing.amount=-1", "--debug")
    assert code == 2
    assert "Traceback" in err


def test_a_bug_is_not_taken_for_a_mistake(command: Command) -> None:
    with pytest.raises(RuntimeError, match="a bug"):
        command("drawing.amount=13")
    assert files() == []


def test_an_override_that_has_no_effect_is_doubted(command: Command) -> None:
    code, _, err = command("gap.anything=1", "clean.crash=false", "clean=gently")
    assert code == 0
    assert err == (
        "warning: tiny_stage does not read 'gap', so 'gap.anything=1' has no effect\n"
        "warning: tiny_stage does not read 'clean', so 'clean.crash=false' has no effect\n"
    )


def test_a_path_needs_no_quotes(command: Command) -> None:
    Path("my flight (1), 50%='best'.csv").write_text("t\n")
    code, _, err = command("recording=my flight (1), 50%='best'.csv", "output=a b/[c]")
    assert (code, err) == (0, "")
    assert files("a b/[c]") == ["a b/[c]/.simgap", "a b/[c]/draws", "a b/[c]/metrics.json"]


def test_a_folder_of_ones_own_adds_to_the_groups_and_goes_first(command: Command) -> None:
    mine = Path("mine/platform")
    mine.mkdir(parents=True)
    (mine / "heron.yaml").write_text("mass: 0.1\n")
    (mine / "sparrow.yaml").write_text("mass: 0.2\n")
    for name, mass in [("heron", 0.1), ("sparrow", 0.2), ("eagle", 4.0)]:
        code, out, _ = command("--config-dir", "mine", f"platform={name}", "--cfg")
        assert code == 0
        assert f"mass: {mass}\n" in out
    assert command("--config-dir", "nowhere")[2].startswith("simgap tiny_stage: nowhere: is not a directory")
    (mine / "broken.yaml").write_text("mass: [\n")
    code, _, err = command("--config-dir", "mine", "platform=broken")
    assert (code, err.count("\n")) == (2, 1)
    assert "not valid YAML" in err


def test_a_folder_of_ones_own_may_hold_anything(command: Command) -> None:
    for name in ("output", "recording", "platform"):
        Path(name).mkdir()
    Path("platform/heron.yaml").write_text("mass: 0.1\n")
    Path("recording/flight.csv").write_text("t\n")
    arguments = ["--config-dir", ".", "platform=heron", "recording=recording/flight.csv", "output=output"]
    for _ in range(2):
        code, _, err = command(*arguments)
        assert (code, err) == (0, "")
    assert files("output") == ["output/.simgap", "output/draws", "output/metrics.json"]


def test_cfg_prints_what_the_stage_reads_and_stops(command: Command) -> None:
    code, out, _ = command("drawing.amount=7", "--cfg")
    assert code == 0
    assert "  amount: 7\n" in out
    assert "gap:" not in out
    assert files() == []


def test_help_says_what_the_stage_does(tiny: ModuleType, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as caught:
        run_command(tiny.tiny_stage, ["--help"])
    assert caught.value.code == 0
    text = capsys.readouterr().out
    assert "Draw some numbers." in text
    assert "recording, platform, drawing" in text
