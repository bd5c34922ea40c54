"""LeRobot data sets, version 2 and 3: Parquet files of frames, and a description in meta/info.json.

Source: the documentation of LeRobotDataset at huggingface.co/docs/lerobot.
"""

import json
from collections.abc import Callable, Collection, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simgap.errors import InputError
from simgap.logs.log import Log, Signal, Span
from simgap.logs.records import RecordSignals

_TIME, _EPISODE = "timestamp", "episode_index"
_UNUSED = ("frame_index", "index", "task_index", "next.done")
_MOST = 200_000_000  # numbers of a data set that are read, 1.6 GB: 300 hours of twelve joints at 15 Hz
_WIDEST = 1000  # elements of a feature; more than any robot has joints
Numbers = NDArray[np.floating[Any]]
"""As they are stored: most data sets have 32 bits."""

_BETWEEN = 1.0  # s from one episode to the next, so that they share no time


def read(path: Path) -> Log:
    """Read the numbers of a data set: `action[joint]`, `observation.state[joint]` and so on; one run per episode.

    Each episode begins at time 0; they are laid one behind the other.

    Args:
        path: the folder of the data set, or one of its Parquet files.

    Raises:
        InputError: when a file is damaged, or holds no frames.
    """
    folder = _folder(path)
    info = _info(folder) if folder is not None else {}
    fps = _number(info.get("fps"))
    columns = _columns(_files(path), {*_UNUSED, _TIME} if fps > 0 else {*_UNUSED}, str(path))
    episodes = columns.pop(_EPISODE, None)
    if episodes is None or not len(episodes):
        raise InputError("holds no frames of an episode", str(path), "give the folder of a LeRobot data set")
    mixed = bool((np.diff(episodes) < 0).any())
    order = np.argsort(episodes, kind="stable") if mixed else slice(None)
    times, spans = _times(episodes[order], _sorted(columns.get(_TIME), order), fps, str(path))
    made = {
        label: signal
        for name, values in columns.items()
        if name != _TIME
        for label, signal in _signals(name, values[order], times, _labels(info, name))
    }
    facts = {key: str(info[key]) for key in ("robot_type", "codebase_version", "fps") if info.get(key)}
    return Log("LeRobot", str(path), RecordSignals({}, made), spans, facts)


def _folder(path: Path) -> Path | None:
    """Return the folder of the data set; None for a file on its own."""
    places = [path, *path.absolute().parents[:3]] if path.is_file() else [path]
    return next((place for place in places if (place / "meta" / "info.json").is_file()), None)


def _info(folder: Path) -> dict[str, Any]:
    place = folder / "meta" / "info.json"
    try:
        content = json.loads(place.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        raise InputError("is no readable JSON", str(place), "copy the data set again") from None
    if not isinstance(content, dict):
        raise InputError("is no description of a data set", str(place), "copy the data set again")
    return content


def _files(path: Path) -> list[Path]:
    files = [path] if path.is_file() else sorted((path / "data").glob("chunk-*/*.parquet"))
    if not files:
        raise InputError(
            "holds no data/chunk-*/*.parquet", str(path), "download the data, too, not only meta"
        )
    return files


def _columns(files: list[Path], unused: Collection[str], where: str) -> dict[str, Numbers]:
    """Return the numbers of each column but the unused ones, (frames,) or (frames, elements)."""
    parts: dict[str, list[Numbers]] = {}
    total = 0
    for file in files:
        found, count = _of_file(file, unused, _MOST - total)
        total += count
        if parts and set(found) != set(parts):
            raise InputError("has other columns than the files before", str(file), "copy the data set again")
        for name, values in found.items():
            parts.setdefault(name, []).append(values)
    try:
        return {
            name: np.concatenate(values) if len(values) > 1 else values[0] for name, values in parts.items()
        }
    except ValueError:
        raise InputError(
            "its files hold joints of different numbers", where, "copy the data set again"
        ) from None


def _of_file(path: Path, unused: Collection[str], most: int) -> tuple[dict[str, Numbers], int]:
    """Return the columns of one file that hold numbers, and how many numbers that are."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        file = pq.ParquetFile(path)
        fields = [entry for entry in file.schema_arrow if entry.name not in unused]
        names = [entry.name for entry in fields if _is_numeric(entry.type)]
        widths = sum(
            entry.type.list_size if pa.types.is_fixed_size_list(entry.type) else 1
            for entry in file.schema_arrow
            if entry.name in names
        )
        count = file.metadata.num_rows * widths
        if count > most:
            raise InputError("holds too many frames", str(path), "give one file of the data set")
        found = {}
        for name in names:  # one by one, so that none is held twice
            found[name] = _array(_column(file, name))
            pa.default_memory_pool().release_unused()
    except (pa.ArrowException, OSError, ValueError, OverflowError) as error:
        reason = (str(error).splitlines() or ["damaged"])[0]
        raise InputError(f"cannot be read ({reason})", str(path), "copy the data set again") from None
    return {name: values for name, values in found.items() if values is not None}, count


def _column(file: Any, name: str) -> Any:
    return file.read(columns=[name], use_threads=False).column(name).combine_chunks()


def _is_numeric(kind: Any) -> bool:
    import pyarrow as pa

    if pa.types.is_fixed_size_list(kind) and kind.list_size > _WIDEST:
        return False
    inner = kind.value_type if pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind) else kind
    return bool(pa.types.is_floating(inner) or pa.types.is_integer(inner) or pa.types.is_boolean(inner))


def _array(column: Any) -> Numbers | None:
    """Return a column as (frames,) or (frames, elements); None where its rows differ in length."""
    import pyarrow as pa

    if not (pa.types.is_list(column.type) or pa.types.is_fixed_size_list(column.type)):
        return _numbers(column)
    values = _numbers(column.flatten())
    width, rest = divmod(len(values), len(column)) if len(column) else (0, 0)
    if rest or not 0 < width <= _WIDEST:
        return None
    if pa.types.is_list(column.type) and (np.diff(column.offsets.to_numpy()) != width).any():
        return None
    return values.reshape(len(column), width)


def _numbers(column: Any) -> Numbers:
    """Return numbers in 32 bits where they are stored so, else in 64 bits."""
    values = column.to_numpy(zero_copy_only=False)
    return values if values.dtype == np.float32 else np.asarray(values, dtype=np.float64)


def _sorted(values: Numbers | None, order: NDArray[np.int64] | slice) -> Numbers | None:
    return None if values is None else values[order]


def _times(
    episodes: Numbers, stamps: Numbers | None, fps: float, where: str
) -> tuple[NDArray[np.float64], tuple[Span, ...]]:
    """Return the time of each frame, s, and the episodes, one behind the other."""
    if stamps is None and not fps > 0:
        raise InputError(
            "has neither timestamps nor a number of frames per second", where, "set fps in meta/info.json"
        )
    starts = np.flatnonzero(np.diff(episodes, prepend=np.nan) != 0)
    times = np.empty(len(episodes))
    spans = []
    begin = 0.0
    told = np.empty(0) if stamps is None else stamps.astype(np.float64)
    for first, after in zip(starts, [*starts[1:], len(episodes)], strict=True):
        # Timestamps are stored with 24 bits; fps, where it is known, says them exactly.
        own = np.arange(after - first) / fps if fps > 0 else told[first:after]
        times[first:after] = begin + own - own[0]
        spans.append(Span(f"episode_{episodes[first]:.0f}", begin, float(times[after - 1])))
        begin = float(times[after - 1]) + _BETWEEN
    return times, tuple(spans)


def _signals(
    name: str, values: Numbers, times: NDArray[np.float64], labels: list[str]
) -> Iterator[tuple[str, Callable[[], Signal]]]:
    """Yield the name of each signal, and what makes it."""
    if values.ndim == 1:
        yield name, partial(_signal, name, times, values, name == "action")
        return
    marks = labels if len(labels) == values.shape[1] else [str(place) for place in range(values.shape[1])]
    for mark, column in zip(marks, values.T, strict=True):
        label = f"{name}[{mark}]"
        yield label, partial(_signal, label, times, column, name == "action")


def _signal(name: str, times: NDArray[np.float64], values: Numbers, held: bool) -> Signal:
    with np.errstate(invalid="ignore"):  # a signalling NaN
        return Signal(name, times, np.ascontiguousarray(values, dtype=np.float64), held=held)


def _labels(info: Mapping[str, Any], feature: str) -> list[str]:
    """Return the names of a feature's elements, without the `.pos` behind them; empty where none are told."""
    features = info.get("features")
    entry = features.get(feature) if isinstance(features, dict) else None
    names = entry.get("names") if isinstance(entry, dict) else None
    if isinstance(names, dict):  # version 2.0 has {"motors": [...]}
        names = next(iter(names.values()), None)
    if not isinstance(names, list) or len(set(map(str, names))) != len(names):
        return []
    return [str(name).removesuffix(".pos") for name in names]


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) and not isinstance(value, bool) else 0.0
