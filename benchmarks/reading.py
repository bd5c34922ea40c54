"""How fast logs of a million records are read: python -m benchmarks.reading --output PAGE.

Each log is read in a process of its own, and imported and cleaned in another, after a small one of the same format, so
that what is imported late, and the loops that are compiled, are there.
Times are of the processor. Memory is the most that the process held, less what it held before, over the file's size.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from datetime import date
from pathlib import Path
from typing import TypeVar

from benchmarks.large_logs import MAKERS
from benchmarks.page import machine
from simgap.recordings.recording import Recording

MAPPING = "mapping.yaml"
_SMALL = 6_000  # records
_DOUBTED = ("MCAP, JSON", "Crazyflie")  # no units; a thrust or a speed
_BESIDE = ("small", MAPPING, "imported.parquet")  # what lies beside a log
_SECONDS, _RATE, _TIMES = 5.0, 2.0, 4.0  # the targets
_KIB = 1024
_PEAK = "VmHWM:"  # in Linux's status of a process; what getrusage tells goes back to before the program began
_PAGE = """# Speed of reading logs

Made by `{command}` on {day}. {machine}

Each log has {records:,} records: rows of a table, messages of a bag, or records of one number (WPILOG) or one topic
(ULog, DataFlash, Crazyflie). It holds a joint that swings or a quadrotor that sways, and is written by the encoders of
the tests. All times are of one processor core, the median of {rounds}. The targets are 5 s for `simgap inspect`, its
start included; 2 million records a second for importing and for cleaning; and memory within 4 times the file.

- *read* is from the file to signals, *import* from the file to a recording in Parquet.
- *clean* is `simgap clean`, in rows of the recording.
- *memory* is the most that the process held beyond what it held before, over the size of the file. A log is read in one
  process, and imported and cleaned in another.
  Formats that are compressed (Parquet, LeRobot, Blackbox) hold less in the file than their numbers need.
- *columns* are those of the recording. Cleaning looks at each of them.

| format | file, MB | columns | inspect, s | read | import | clean, 10⁶/s | memory: read | import | clean |
|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|
{rows}

{verdict}

The times leave out what is imported and compiled once. From 8 MiB on, a loop over the records of ULog, MCAP and
Crazyflie logs is compiled, and over JSON that repeats but for its numbers: that takes half a second the first time, and
0.4 s in each later process. JSON whose messages differ otherwise, or bear stamps or booleans, is left to Arrow's
parser, which takes three times as long.

Where importing misses its rate, what is left is the work of a library, or spread over all columns:

- MCAP in JSON lies at the bar: from run to run it is up to a tenth above or below it.
- ROS 2 bags: SQLite finds each message by the index of the times, and copies it, which takes half of the time.
- Blackbox: the numbers of a frame are as long as they have to be. Decoding them takes a third of the time, a tenth is
  Parquet, and the rest is finding out what the signals are, and resampling to one rate, column by column.

Cleaning looks at every number: a quadrotor has four to seven times the columns of a joint, and an offset between two
clocks is estimated of it, which takes some 0.04 s however long the recording is. A recording takes 8 bytes a number in
memory; cleaning copies those columns that it changes. That is several times the file where this is compressed, or holds
numbers of two or four bytes.
"""
Result = TypeVar("Result")


def _timed(work: Callable[[], Result]) -> tuple[Result, float]:
    begin = time.process_time()
    result = work()
    return result, time.process_time() - begin


def _held() -> int:
    """Return the most that this process held so far, bytes."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return next(int(line.split()[1]) * _KIB for line in lines if line.startswith(_PEAK))


def _read(path: Path) -> dict[str, float]:
    """Read a log; return the time of the processor, s, and memory, bytes."""
    from simgap.logs.formats import read_log

    before = _held()
    read = _timed(lambda: read_log(path) and None)[1]
    return {"read": read, "read_memory": _held() - before}


def _imported(path: Path) -> dict[str, float]:
    """Import and clean a log; return processor times, s, memories, bytes, and rows of the recording.

    A log of which it is not sure which signal is which column gets the mapping that is proposed.
    """
    from simgap.logs.opening import open_recording
    from simgap.recordings.cleaning import clean_recording
    from simgap.recordings.recording import write_recording

    before = _held()
    mapping = path.with_name(MAPPING)

    def imported() -> Recording:
        recording = open_recording(path, mapping=mapping if mapping.exists() else None)
        write_recording(recording, path.parent / "imported.parquet")
        return recording

    recording, seconds = _timed(imported)
    found = {"import": seconds, "import_memory": _held() - before}
    found["clean"] = _timed(lambda: clean_recording(recording) and None)[1]
    found["clean_memory"] = _held() - before
    return found | {"rows": len(recording.frame), "columns": len(recording.channels)}


_PARTS = {"read": _read, "import": _imported}


def _measure(part: str, small: Path, large: Path) -> None:
    from simgap import compiled

    compiled.LARGE, large_enough = 0, compiled.LARGE
    _PARTS[part](small)
    compiled.LARGE = large_enough
    print(json.dumps(_PARTS[part](large)))


def _measured(small: Path, large: Path) -> dict[str, float]:
    """Return what all parts tell, each in a process of its own."""
    found: dict[str, float] = {}
    for part in _PARTS:
        command = [sys.executable, "-m", "benchmarks.reading", "--measure", part, str(small), str(large)]
        found |= json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    return found


def _size(path: Path) -> int:
    return sum(file.stat().st_size for file in path.rglob("*")) if path.is_dir() else path.stat().st_size


def _inspected(path: Path) -> float:
    """Return how long `simgap inspect` takes, s of the processor, its start included."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "simgap", "inspect", str(path), "-o", str(path.with_name(MAPPING))]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def _made(name: str, folder: Path, records: int) -> Path:
    """Return a log; one that is there already is taken as it is."""
    folder.mkdir(parents=True, exist_ok=True)
    found = [path for path in folder.iterdir() if path.name not in _BESIDE]
    return found[0] if found else MAKERS[name](folder, records)


def row(name: str, records: int, rounds: int, logs: Path | None) -> str:
    """Return the line of a format: medians of the rounds."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = (logs or Path(temporary)) / name.replace(",", "").replace(" ", "_")
        small, large = _made(name, folder / "small", _SMALL), _made(name, folder, records)
        size = _size(large)
        inspected = sorted(_inspected(large) for _ in range(rounds))
        _inspected(small)
        if name not in _DOUBTED:
            small.with_name(MAPPING).unlink(missing_ok=True)
            large.with_name(MAPPING).unlink(missing_ok=True)
        found = [_measured(small, large) for _ in range(rounds)]
    best = {key: sorted(each[key] for each in found)[rounds // 2] for key in found[0]}
    rates = [records / best["read"], records / best["import"], best["rows"] / best["clean"]]
    memories = [best[f"{part}_memory"] / size for part in ("read", "import", "clean")]
    numbers = [f"{size / 1e6:.0f}", f"{best['columns']:.0f}", f"{inspected[rounds // 2]:.1f}"]
    numbers += [f"{rate / 1e6:.2f}" for rate in rates] + [f"{share:.1f}" for share in memories]
    return f"| {name} | {' | '.join(numbers)} |"


def _verdict(rows: list[str]) -> str:
    """Return which formats miss which target, by the figures of their lines."""
    figures = {
        cells[1].strip(): [float(cell) for cell in cells[2:-1]] for cells in (row.split("|") for row in rows)
    }
    missed = {
        f"`simgap inspect` in {_SECONDS:g} s": [name for name, f in figures.items() if f[2] > _SECONDS],
        f"Importing {_RATE:g} million a second": [name for name, f in figures.items() if f[4] < _RATE],
        f"Cleaning {_RATE:g} million a second": [name for name, f in figures.items() if f[5] < _RATE],
        f"Importing within {_TIMES:g} times the file": [name for name, f in figures.items() if f[7] > _TIMES],
        f"Cleaning within {_TIMES:g} times the file": [name for name, f in figures.items() if f[8] > _TIMES],
    }
    lines = []
    for target, names in missed.items():
        told = f"missed by {', '.join(names)}" if names else "met by all"
        lines.append(f"- {target}: {told}.")
    return "\n".join(lines)


def main() -> None:
    """Write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.reading")
    parser.add_argument("--records", type=int, default=1_000_000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--formats", nargs="*", default=list(MAKERS))
    parser.add_argument("--logs", type=Path, help="folder that keeps the logs for the next time")
    parser.add_argument("--output", type=Path, default=Path("docs/benchmark_reading.md"))
    parser.add_argument("--measure", nargs=3, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.measure:
        part, small, large = chosen.measure
        _measure(part, Path(small), Path(large))
        return
    load, rows = os.getloadavg()[0], []
    for name in chosen.formats:
        rows.append(row(name, chosen.records, chosen.rounds, chosen.logs))
        print(rows[-1], flush=True)
    text = _PAGE.format(
        command=f"python -m benchmarks.reading {' '.join(sys.argv[1:])}".strip(),
        day=date.today().isoformat(),
        machine=machine("cpu", load),
        records=chosen.records,
        rounds="one run" if chosen.rounds == 1 else f"{chosen.rounds} runs",
        rows="\n".join(rows),
        verdict=_verdict(rows),
    )
    chosen.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
