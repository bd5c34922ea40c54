"""Many cases side by side, killed and continued."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from simgap.benchmark.running import RESULT, run_cases, write_whole


def square(task, folder):
    """Work that leaves a trace of every time it was done."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / "done").open("a") as trace:
        trace.write("x")
    return {"squared": task**2}


def wait(task, folder):
    """Work that says which process does it and goes on until that is ended."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "process").write_text(str(os.getpid()))
    time.sleep(600)
    return {}


def is_alive(process):
    """Whether a process goes on; one that nobody asked how it ended is a zombie, and does not."""
    stat = Path(f"/proc/{process}/stat")
    return stat.exists() and stat.read_text().rpartition(")")[2].split()[0] != "Z"


def eventually(happens):
    for _ in range(600):
        if happens():
            return True
        time.sleep(0.1)
    return False


def run(tmp_path, tasks, identity=str):
    return run_cases(tasks, square, tmp_path, 2, identity)


def times(tmp_path, name):
    return len((tmp_path / name / "done").read_text())


def test_results_come_in_the_order_of_the_tasks(tmp_path):
    results = run(tmp_path, {"c": 3, "a": 1, "b": 2})
    assert [(name, result["squared"]) for name, result in results.items()] == [("c", 9), ("a", 1), ("b", 4)]


def test_what_is_done_is_not_done_again_and_what_was_killed_is(tmp_path):
    run(tmp_path, {"a": 1, "b": 2})
    (tmp_path / "b" / RESULT).unlink()
    results = run(tmp_path, {"a": 1, "b": 2, "c": 3})
    assert [result["squared"] for result in results.values()] == [1, 4, 9]
    assert [times(tmp_path, name) for name in "abc"] == [1, 2, 1]


def test_an_answer_to_another_question_is_not_taken(tmp_path):
    run(tmp_path, {"a": 1})
    assert run(tmp_path, {"a": 5})["a"]["squared"] == 25
    run(tmp_path, {"a": 5}, identity=lambda task: f"{task} by other code")
    assert times(tmp_path, "a") == 3


def test_a_case_that_failed_is_tried_again(tmp_path):
    run(tmp_path, {"a": 1})
    path = tmp_path / "a" / RESULT
    write_whole(json.loads(path.read_text()) | {"failed": "TypeError: no"}, path)
    assert "failed" not in run(tmp_path, {"a": 1})["a"]
    assert times(tmp_path, "a") == 2


def test_nothing_to_do_needs_no_process(tmp_path):
    assert run(tmp_path, {}) == {}


def test_a_result_is_whole_or_not_there(tmp_path):
    path = tmp_path / "deep" / RESULT
    write_whole({"a": 1}, path)
    with pytest.raises(TypeError):
        write_whole({"a": object()}, path)
    assert json.loads(path.read_text()) == {"a": 1}
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
@pytest.mark.parametrize("sign", [signal.SIGTERM, signal.SIGKILL])
def test_no_process_of_a_killed_run_goes_on(tmp_path, sign):
    waits = (
        "from pathlib import Path\n"
        "from simgap.benchmark.running import run_cases\n"
        "from tests.pipeline.benchmark.test_running import wait\n"
        "if __name__ == '__main__':\n"
        f"    run_cases({{'a': 1, 'b': 2}}, wait, Path({str(tmp_path)!r}), 2, str)\n"
    )
    script = tmp_path / "waits.py"
    script.write_text(waits)
    root = str(Path(__file__).parents[3])
    run = subprocess.Popen([sys.executable, str(script)], env={**os.environ, "PYTHONPATH": root})
    processes = [tmp_path / name / "process" for name in "ab"]
    assert eventually(lambda: all(each.exists() and each.read_text() for each in processes))
    run.send_signal(sign)
    run.wait()
    assert eventually(lambda: not any(is_alive(each.read_text()) for each in processes))
