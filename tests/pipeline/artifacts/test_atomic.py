import errno
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from simgap.artifacts import staged_directory
from simgap.errors import InputError


def write(target: Path, owned: bool = False, **files: str) -> None:
    with staged_directory(target, owned) as staging:
        for name, text in files.items():
            (staging / name).write_text(text)


def write_half(target: Path, error: Exception) -> None:
    with staged_directory(target) as staging:
        (staging / "file").write_text("half")
        raise error


def content(folder: Path) -> dict[str, str]:
    return {
        p.relative_to(folder).as_posix(): p.read_text()
        for p in folder.rglob("*")
        if p.is_file() and p.name != ".simgap"
    }


def test_nothing_is_there_before_the_end(tmp_path: Path) -> None:
    target = tmp_path / "a" / "stage"
    with staged_directory(target) as staging:
        (staging / "file").write_text("whole")
        assert not target.exists()
    assert content(tmp_path) == {"a/stage/file": "whole"}


def test_a_failure_leaves_nothing_and_keeps_what_was_there(tmp_path: Path) -> None:
    target = tmp_path / "a" / "stage"
    with pytest.raises(ZeroDivisionError):
        write_half(target, ZeroDivisionError())
    assert list(tmp_path.iterdir()) == []
    write(target, file="old")
    with pytest.raises(ZeroDivisionError), staged_directory(target, owned=True):
        raise ZeroDivisionError
    assert content(tmp_path) == {"a/stage/file": "old"}


def test_an_owned_directory_is_replaced_as_a_whole(tmp_path: Path) -> None:
    write(tmp_path / "stage", first="1", second="2")
    write(tmp_path / "stage", owned=True, first="3")
    assert content(tmp_path) == {"stage/first": "3"}


def write_answer(home: Path, name: str) -> None:
    with staged_directory(home) as staging:
        (staging / "diagnosis.json").write_text("{}")
        (staging / "simulator").mkdir()
        (staging / "simulator" / name).write_text(name)


def test_earlier_output_is_replaced_and_foreign_files_stay(tmp_path: Path) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (home / "thesis.tex").write_text("years of work")
    for name in ("old.yaml", "new.yaml"):
        write_answer(home, name)
    assert content(home) == {
        "thesis.tex": "years of work",
        "diagnosis.json": "{}",
        "simulator/new.yaml": "new.yaml",
    }
    assert (home / ".simgap").read_text() == "diagnosis.json\nsimulator\n"
    assert [path.name for path in tmp_path.iterdir()] == ["home"]


@pytest.mark.parametrize(("name", "worked"), [("simulator", False), ("drawing", True)])
def test_a_foreign_entry_of_a_name_that_is_written_is_never_replaced(
    tmp_path: Path, name: str, worked: bool
) -> None:
    """What most stages write is refused before the work, any other name after it."""
    own, done = tmp_path / name, False
    own.mkdir()
    (own / "years.txt").write_text("of work")
    refusal = pytest.raises(InputError, match=f"holds {name}, which simgap did not write")
    with refusal, staged_directory(tmp_path) as staging:
        done = True
        (staging / name).mkdir()
    assert done is worked
    assert content(tmp_path) == {f"{name}/years.txt": "of work"}


def test_a_target_without_a_writable_parent_is_written_from_inside(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    volume = tmp_path / "volume"
    volume.mkdir()
    (volume / "notes").write_text("mine")
    monkeypatch.setattr(os.path, "ismount", lambda path: Path(path) == volume)
    with staged_directory(volume) as staging:
        assert staging.parent == volume
        (staging / "file").write_text("new")
    assert content(volume) == {"notes": "mine", "file": "new"}


def test_a_link_to_a_directory_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to("real")
    write(tmp_path / "link", owned=True, file="1")
    assert (tmp_path / "link").is_symlink()
    assert content(tmp_path / "real") == {"file": "1"}


KILLED = """
import sys, time
from simgap.artifacts import staged_directory
with staged_directory(sys.argv[1]) as staging:
    (staging / "file").write_text("half")
    print("ready", flush=True)
    time.sleep(60)
"""


def kill_in_the_middle(target: Path) -> None:
    process = subprocess.Popen([sys.executable, "-c", KILLED, str(target)], stdout=subprocess.PIPE)
    assert process.stdout is not None
    process.stdout.readline()
    process.send_signal(signal.SIGKILL)
    process.communicate()


def test_what_a_killed_process_left_is_removed_by_the_next(tmp_path: Path) -> None:
    target = tmp_path / "stage"
    kill_in_the_middle(target)
    (left,) = tmp_path.iterdir()
    assert left.name.startswith(".partial-stage-")
    write(target, file="whole")
    assert content(tmp_path) == {"stage/file": "whole"}


def test_what_another_process_is_writing_is_left_alone(tmp_path: Path) -> None:
    target = tmp_path / "stage"
    with staged_directory(target) as slow:
        (slow / "file").write_text("slow")
        write(target, file="fast")
        assert content(target) == {"file": "fast"}
    assert content(tmp_path) == {"stage/file": "slow"}


def test_death_between_the_two_renames_of_a_swap_keeps_the_old_state(tmp_path: Path) -> None:
    replaced = tmp_path / ".partial-stage-0123abcd.replaced"
    replaced.mkdir()
    (replaced / "file").write_text("old")
    with pytest.raises(ZeroDivisionError), staged_directory(tmp_path / "stage"):
        raise ZeroDivisionError
    assert content(tmp_path) == {"stage/file": "old"}


def test_writers_that_end_together_leave_one_whole_state(tmp_path: Path) -> None:
    barrier = threading.Barrier(4, timeout=20)

    def work(name: str) -> None:
        with staged_directory(tmp_path / "stage", owned=True) as staging:
            for index in range(20):
                (staging / f"{index}").write_text(name)
            barrier.wait()

    threads = [threading.Thread(target=work, args=(name,)) for name in "abcd"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    result = content(tmp_path)
    assert len(result) == 20
    assert len(set(result.values())) == 1


@pytest.mark.parametrize("target", ["file", "file/below", "/proc/simgap/stage", "a" * 300])
def test_an_impossible_place_is_said_in_one_line(tmp_path: Path, target: str) -> None:
    (tmp_path / "file").write_text("a file")
    with pytest.raises(InputError, match="output=DIR") as caught:
        write(tmp_path / target, x="1")
    assert target in str(caught.value)
    assert content(tmp_path) == {"file": "a file"}


def test_a_read_only_place_is_said_in_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(self: Path, *arguments: object, **keywords: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", str(self))

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(InputError, match=r"stage: cannot be written \(Permission denied\)"):
        write(tmp_path / "stage")


@pytest.mark.parametrize(
    "error",
    [
        OSError(errno.ENOSPC, "No space left on device"),
        RuntimeError("I/O error: No space left on device (28)"),
    ],
)
def test_a_full_disk_is_said_in_one_line(tmp_path: Path, error: Exception) -> None:
    target = tmp_path / "stage"
    with pytest.raises(InputError, match=f"^{target}: the disk is full; free some space"):
        write_half(target, error)
    assert list(tmp_path.iterdir()) == []


def test_a_really_full_disk(tmp_path: Path) -> None:
    """A file that outgrows its limit (RLIMIT_FSIZE) is what a full disk looks like to a writer."""
    code = """
import resource, signal, sys
from simgap.artifacts import staged_directory
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
with staged_directory(sys.argv[1]) as staging:
    (staging / "file").write_bytes(bytes(5000))
"""
    target = str(tmp_path / "stage")
    done = subprocess.run([sys.executable, "-c", code, target], capture_output=True, text=True, check=False)
    assert f"InputError: {target}: the disk is full" in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_mistake_is_said_of_the_place_that_a_person_knows(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught, staged_directory(tmp_path / "stage") as staging:
        raise InputError("cannot be written", str(staging / "recording.parquet"))
    assert str(caught.value) == f"{tmp_path}/stage/recording.parquet: cannot be written"


def test_the_errors_of_other_files_are_not_taken_for_its_own(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), staged_directory(tmp_path / "stage"):
        (tmp_path / "absent").read_text()
