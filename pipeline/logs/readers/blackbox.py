"""Blackbox logs of Betaflight, INAV and Cleanflight: one file, often several logs one behind the other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.log import Log, Signal, Span
from simgap.logs.readers.blackbox_header import Header, header_of, settings_of, starts_of
from simgap.logs.readers.blackbox_units import scale_of
from simgap.logs.records import RecordSignals

_PAUSE = 1.0  # s put between two logs on the common clock; any time above zero does
_VALUES_PER_BYTE = 8  # of the densest encoding, which has a bit for each value that is as predicted
_FEWEST = 2  # frames of a log
_TURN = 1 << 32  # µs at which the clock of a frame begins anew
_FACTS = (
    "Firmware revision", "Board information", "Craft name", "Log start datetime", "looptime", "P interval",
    "acc_1G", "blackbox_high_resolution", "minthrottle", "maxthrottle", "motorOutput", "dshot_idle_value",
    "motor_pwm_protocol", "dshot_bidir", "motor_poles", "yaw_motors_reversed", "vbatref",
)  # fmt: skip


@dataclass(frozen=True)
class _Decoded:
    """One log of a file.

    Attributes:
        number: in the file, from 1.
        header: of it.
        time: of the main frames, s since the first, increasing.
        main: the fields of the main frames, (frames, fields), as 32 bits.
        slow: times, s, and fields of the frames that are written on change.
        gps: the same of the GPS frames.
        damaged: places at which frames were lost.
        closed: whether the end of the log is marked.
    """

    number: int
    header: Header
    time: NDArray[np.float64]
    main: NDArray[np.int32]
    slow: tuple[NDArray[np.float64], NDArray[np.int32]]
    gps: tuple[NDArray[np.float64], NDArray[np.int32]]
    damaged: int
    closed: bool


def read(path: Path) -> Log:
    """Read all logs of a file, their clocks one behind the other; each is a span.

    Gyroscope in deg/s, accelerometer in g, voltage in V and current in A, by the scales of the header; all else in the
    firmware's own numbers. Damaged frames are left out.

    Raises:
        InputError: when the file cannot be read, or has no log with frames.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), "check its permissions") from None
    starts = starts_of(data)
    if not starts:
        raise InputError(
            "holds no blackbox log", str(path), "give the file as the flight controller wrote it"
        )
    found = _decoded(data, starts)
    logs = [log for log in found if len(log.time) >= _FEWEST]
    if not logs:
        raise InputError(
            f"has no frames in any of its {len(starts)} logs",
            str(path),
            "record a flight with the blackbox on",
        )
    begins = np.cumsum([0.0, *(float(log.time[-1]) + _PAUSE for log in logs)])
    return Log(
        format="Blackbox",
        path=str(path),
        signals=_signals(logs, begins),
        spans=tuple(
            Span(f"log {log.number}", float(begin), float(begin + log.time[-1]))
            for log, begin in zip(logs, begins, strict=False)
        ),
        facts={name: logs[0].header.facts[name] for name in _FACTS if name in logs[0].header.facts},
        remarks=tuple(_remarks(logs, len(starts))),
    )


def _decoded(data: bytes, starts: Sequence[int]) -> list[_Decoded]:
    found = []
    for number, (start, end) in enumerate(zip(starts, [*starts[1:], len(data)], strict=True), 1):
        header = header_of(data, start, end)
        if header is not None:
            found.append(_decode(data[header.end : end], header, number))
    return found


def _decode(data: bytes, header: Header, number: int) -> _Decoded:
    from simgap.logs.readers.blackbox_frames import decode  # with numba: after what can be refused

    intra, inter, slow, gps, home = (header.table(kind) for kind in "IPSGH")
    tables = intra, inter, slow, gps, home
    rows = _room(data, intra), _room(data, slow), _room(data, gps)
    stamps = np.empty((2, max(len(rows[1]), len(rows[2]))), dtype=np.int64)
    counts = decode(np.frombuffer(data, dtype=np.uint8), tables, settings_of(header), rows, stamps)
    main = rows[0][: counts[0]]
    clock = main[:, header.frames["I"].names.index("time")].astype(np.int64)
    time, kept = _seconds(clock)
    first = int(clock[kept][0]) if kept.any() else 0
    others = [
        (_since(stamps[place, : counts[1 + place]], first), rows[1 + place][: counts[1 + place]].copy())
        for place in range(2)
    ]
    if not kept.all():
        time, main = time[kept], main[kept]
    return _Decoded(number, header, time, main, others[0], others[1], int(counts[3]), bool(counts[4]))


def _room(data: bytes, table: NDArray[np.int64]) -> NDArray[np.int32]:
    """Return room for as many frames with these fields as the data may hold, (frames, fields).

    What is never written takes no memory: rows beyond those that are there only have addresses.
    """
    fields = table.shape[1]
    return np.empty((_VALUES_PER_BYTE * len(data) // fields + 1 if fields else 0, fields), dtype=np.int32)


def _since(clock: NDArray[np.int64], first: int) -> NDArray[np.float64]:
    """Return the seconds since the first main frame of a log, over a turn of the clock."""
    passed = (clock - first + _TURN // 2) % _TURN - _TURN // 2
    return np.maximum(passed, 0) * 1e-6


def _seconds(clock: NDArray[np.int64]) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return seconds since the first frame, and which frames are in order: a frame that is later than others behind it
    is damaged."""
    steps = np.diff(clock, prepend=clock[:1])
    time = np.cumsum((steps + _TURN // 2) % _TURN - _TURN // 2) * 1e-6
    later = np.minimum.accumulate(time[::-1])[::-1]
    kept = np.append(time[:-1] < later[1:], True) if len(time) else np.zeros(0, dtype=bool)
    return time - (time[kept][0] if kept.any() else 0.0), kept


def _signals(logs: Sequence[_Decoded], begins: NDArray[np.float64]) -> RecordSignals:
    """Return the fields of all logs, each on the common clock; fields of one kind of frame share their times."""
    parts: dict[str, list[_Part]] = {}
    for log, begin in zip(logs, begins, strict=False):
        for kind, (time, rows) in {"I": (log.time, log.main), "S": log.slow, "G": log.gps}.items():
            if kind in log.header.frames and len(time):
                for part in _parts(log.header, kind, time + begin, rows):
                    parts.setdefault(part.name, []).append(part)
    clocks = {tuple(id(part.time) for part in each): each for each in parts.values()}
    joined = {key: np.concatenate([part.time for part in each]) for key, each in clocks.items()}
    return RecordSignals(
        {},
        {
            name: partial(_signal, each, joined[tuple(id(part.time) for part in each)])
            for name, each in parts.items()
        },
    )


def _signal(parts: Sequence["_Part"], time: NDArray[np.float64]) -> Signal:
    """Return a field of all logs, at its times."""
    found = [np.asarray(part.scale * part.numbers, dtype=np.float64) for part in parts]
    values = found[0] if len(found) == 1 else np.concatenate(found)
    return Signal(parts[0].name, time, values, parts[0].unit, parts[0].held)


@dataclass(frozen=True)
class _Part:
    """A field of one log: its values are scale · numbers."""

    name: str
    time: NDArray[np.float64]
    numbers: NDArray[np.int32] | NDArray[np.uint32]
    scale: float
    unit: str | None
    held: bool


def _parts(header: Header, kind: str, time: NDArray[np.float64], rows: NDArray[np.int32]) -> Iterator[_Part]:
    """Yield the fields of one kind of frame of one log, in the units of its header."""
    frames = header.frames[kind]
    for place, name in enumerate(frames.names):
        if name not in ("time", "loopIteration"):
            numbers = rows[:, place] if frames.table[2, place] else rows[:, place].view(np.uint32)
            scale, unit = scale_of(name, header)
            yield _Part(name, time, numbers, scale, unit, held=kind == "S")


def _remarks(logs: Sequence[_Decoded], in_file: int) -> Iterator[str]:
    if in_file > len(logs):
        yield f"{in_file - len(logs)} of {in_file} logs hold no frames and were left out."
    for log in logs:
        if log.damaged:
            yield (
                f"Log {log.number} is damaged at {log.damaged} place(s): what follows each, up to the next key frame, "
                "was left out."
            )
        elif not log.closed:
            yield f"Log {log.number} ends without its end mark: the recorder was cut off, or its memory was full."
