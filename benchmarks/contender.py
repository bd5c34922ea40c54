"""The protocol between the benchmark and what it measures: each contender is a process that runs laps on request.

A request is a line {"batch": machines, "seconds": how long about, ...}; the answer is a line {"steps": control steps of
each machine, "seconds": how long they took}. A contender sleeps while another runs its lap.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
_ANSWERS = "BENCHMARK_ANSWERS"  # environment variable: where answers are written, since libraries print on the output
Lap = tuple[Callable[[], float], Callable[[], None]]
"""What takes some control steps and returns how many, and what waits until they are done."""


def serve(make: Callable[[dict[str, Any]], Lap]) -> None:
    """Answer requests until the input ends.

    Args:
        make: from a request to a lap; made once for each kind of request.
    """
    answers = os.fdopen(int(os.environ[_ANSWERS]), "w")
    made: dict[str, Lap] = {}
    each: dict[str, float] = {}  # seconds that a call took
    for line in sys.stdin:
        request = json.loads(line)
        seconds = request.pop("seconds")
        kind = json.dumps(request, sort_keys=True)
        if kind not in made:
            made[kind] = make(request)
            _timed(made[kind], 1)  # compiles
            _, each[kind] = _timed(made[kind], 1)
        calls = max(round(seconds / each[kind]), 1)
        steps, taken = _timed(made[kind], calls)
        each[kind] = taken / calls
        answers.write(json.dumps({"steps": steps, "seconds": taken}) + "\n")
        answers.flush()


def _timed(lap: Lap, calls: int) -> tuple[float, float]:
    advance, finish = lap
    start = time.perf_counter()
    steps = sum(advance() for _ in range(calls))
    finish()
    return steps, time.perf_counter() - start


class Contender:
    """A process that runs laps."""

    def __init__(self, python: str, module: str, *arguments: str) -> None:
        answers, written = os.pipe()
        environment = {
            **os.environ,
            "OMP_NUM_THREADS": str(len(os.sched_getaffinity(0))),
            "PYTHONPATH": str(ROOT),
            _ANSWERS: str(written),
        }
        self._process = subprocess.Popen(
            [os.path.abspath(python), "-W", "ignore", "-m", module, *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            text=True,
            env=environment,
            cwd=tempfile.gettempdir(),  # where a library leaves its log
            pass_fds=(written,),
        )
        os.close(written)
        self._answers = os.fdopen(answers)

    def ask(self, **request: Any) -> dict[str, Any]:
        """Return the answer to a request.

        Raises:
            RuntimeError: when the process ended.
        """
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        answer = self._answers.readline()
        if not answer:
            raise RuntimeError(f"{self._process.args} ended with {self._process.wait()}")
        return json.loads(answer)

    def rate(self, seconds: float, **request: Any) -> float:
        """Return control steps of all machines in a second, over a lap of about so many seconds."""
        lap = self.ask(seconds=seconds, **request)
        return request["batch"] * lap["steps"] / lap["seconds"]

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._answers.close()
        self._process.wait()
