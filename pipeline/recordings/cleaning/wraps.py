"""Numbers that were too long for their register: wraps at a power of two or a turn, and a sign that is a bit.

A position and its rate say the same twice. A column is mended if a candidate makes both agree, whatever their units and
signs.
"""

from collections.abc import Iterator

import numpy as np

from simgap.recordings.cleaning.work import RunUnderCleaning

PAIRS = {"joint": [("velocity", "position")]}
PAIRS["quadrotor"] = [(f"velocity_{axis}", f"position_{axis}") for axis in "xyz"]
PAIRS["swerve"] = [(f"steer_velocity_{module}", f"steer_angle_{module}") for module in "1234"]
"""Rates and the positions whose rates they are."""

_TURN = 2.0 * np.pi
_JUMP = 0.4  # of the range of a column: a wrap jumps over the most of it
_ALIKE = 0.1  # of a jump: wraps jump alike
_SAMPLES = 10  # of a column that can be judged
_FEWEST = 3  # jumps that are alike by themselves; fewer have to be a turn or a power of two
_BEFORE, _GAIN = 1e-4, 0.5  # misfit that is looked into, and the share of it that may be left
_ROUNDING = 0.02  # of a size: within it, a whole turn or a power of two is meant
_FULL = 0.1  # by which the range of a wrapped rate may be off its period
_STILL = 0.5  # share of the samples that are far off; above it, they stand still
_BELOW = 0.95  # of a sign bit, which positive numbers stay below
_MOVING = 0.05  # of the energy of the fastest samples

Candidate = tuple[np.ndarray, np.ndarray, str]
"""The mended column, which samples were changed, and how, in words."""


def mend_wraps(run: RunUnderCleaning) -> None:
    """Undo wraps and sign bits in every position and rate of a run."""
    for rate, position in PAIRS.get(run.kind, []):
        if not run.has([rate, position]):
            continue
        jumps = {column: _jumps(_known(run.column(column))) for column in (position, rate)}
        if not any(len(rows) for rows in jumps.values()):
            continue
        left = misfit(run.time, *run.channel(position, rate).T)
        for column, rows in jumps.items():
            if left > _BEFORE and len(rows):
                left = _mend(run, rate, position, column, left)


def _known(values: np.ndarray) -> np.ndarray:
    finite = np.isfinite(values)
    return values if finite.all() else values[finite]


def _jumps(present: np.ndarray) -> np.ndarray:
    """Return the samples after which a column jumps as a wrap does; none in a column of a few samples."""
    if len(present) < _SAMPLES:
        return np.empty(0, dtype=np.int64)
    return np.flatnonzero(np.abs(np.diff(present)) > _JUMP * np.ptp(present))


def _mend(run: RunUnderCleaning, rate: str, position: str, column: str, before: float) -> float:
    """Undo the likeliest wrap of a column that jumps, if any, and return the misfit left of the one `before`."""
    values = {name: run.column(name) for name in (rate, position)}
    best, least = None, _GAIN * before
    for candidate in _candidates(run.time, values[column], values[position], values[rate], column == rate):
        tried = {**values, column: candidate[0]}
        after = misfit(run.time, tried[position], tried[rate])
        if after < least:
            best, least = candidate, after
    if best is None:
        return before
    mended, changed, how = best
    run.replace(changed, column, mended, "wraps", how)
    run.remarks.append(
        f"Channel {column!r} {how} in {int(changed.sum())} samples of run {run.name!r}; it was undone."
    )
    return least


def misfit(time: np.ndarray, position: np.ndarray, rate: np.ndarray) -> float:
    """Return how badly a rate is that of a position: 0 where both agree, 2 where they are unrelated.

    Each is taken by its own usual size, and with either sign: a rate in another unit or frame has not wrapped.
    """
    known = np.isfinite(position) & np.isfinite(rate)
    if known.sum() < 3:
        return 0.0
    time, position, rate = time[known], position[known], rate[known]
    derived = (position[2:] - position[:-2]) / (time[2:] - time[:-2])
    recorded = (rate[2:] + 2.0 * rate[1:-1] + rate[:-2]) / 4.0
    derived, recorded = derived / _usual(derived), recorded / _usual(recorded)
    size = 0.5 * (derived**2 + recorded**2)
    moving = size > _MOVING * np.quantile(size, 0.9)
    if not moving.any():
        return 0.0
    derived, recorded, size = derived[moving], recorded[moving], size[moving]
    return min(float(np.mean((derived - turned) ** 2 / size)) for turned in (recorded, -recorded))


def _usual(rate: np.ndarray) -> float:
    """Return the median size of a rate where it moves."""
    size = np.abs(rate)
    return float(np.median(size[size >= np.sqrt(_MOVING) * np.quantile(size, 0.9)])) or 1.0


def _candidates(
    time: np.ndarray, values: np.ndarray, position: np.ndarray, rate: np.ndarray, is_rate: bool
) -> Iterator[Candidate]:
    """Yield what a column that jumps may have been."""
    known = np.flatnonzero(np.isfinite(values))
    present = values[known]
    steps, jumps = np.diff(present), _jumps(present)
    beside = np.convolve(steps, [0.5, 0.0, 0.5], mode="same")  # what the samples beside a jump move
    usual = np.where(np.abs(beside) < _ALIKE * np.abs(steps), beside, 0.0)
    yield from _placed(values, known, _unwrapped(present, jumps, usual), "wraps")
    if not is_rate:
        speed = np.nan_to_num(rate[known])
        expected = 0.5 * (speed[1:] + speed[:-1]) * np.diff(time[known])
        far = np.flatnonzero(np.abs(steps - expected) > _JUMP * np.ptp(present))
        if len(far):
            yield from _placed(values, known, _unwrapped(present, far, expected), "wraps")
    yield from _placed(values, known, _signed(present), "has its sign in its highest bit")
    if is_rate:
        yield from _placed(values, known, _wrapped_rate(time[known], present, position[known]), "wraps")


def _placed(
    values: np.ndarray, known: np.ndarray, mended: tuple[np.ndarray, float] | None, how: str
) -> Iterator[Candidate]:
    if mended is None:
        return
    result = values.copy()
    result[known] = mended[0]
    changed = np.zeros(len(values), dtype=bool)
    changed[known] = mended[0] != values[known]
    yield result, changed, f"{how} at {mended[1]:.6g}"


def _unwrapped(
    present: np.ndarray, jumps: np.ndarray, expected: np.ndarray
) -> tuple[np.ndarray, float] | None:
    """Add a period at each jump; beyond the steps that are expected, all of them have to be alike."""
    steps = np.diff(present) - expected
    sizes = np.abs(steps)[jumps]
    size = float(np.median(sizes))
    period = _rounded(size, _quantum(present))
    if len(jumps) < _FEWEST and period == size:
        return None
    if np.mean(np.abs(sizes - period) < _ALIKE * period) < 0.9:
        return None
    turns = np.zeros(len(present))
    turns[jumps + 1] = -np.sign(steps[jumps])
    return present + period * np.cumsum(turns), period


def _signed(present: np.ndarray) -> tuple[np.ndarray, float] | None:
    """Take what lies above a gap as negative: its distance from the lowest number there is the size."""
    ordered = np.sort(present)
    widest = int(np.argmax(np.diff(ordered)))
    if ordered[0] < -_ALIKE * np.ptp(present) or ordered[widest] > ordered[widest + 1] * _BELOW:
        return None
    bit = _rounded(float(ordered[widest + 1]), _quantum(present))
    upper = present >= ordered[widest + 1]
    return np.where(upper, bit - present, present), bit


def _wrapped_rate(
    time: np.ndarray, present: np.ndarray, position: np.ndarray
) -> tuple[np.ndarray, float] | None:
    """Add a period wherever the position moves faster by one; a register that wraps is full of numbers."""
    with np.errstate(invalid="ignore", divide="ignore"):
        missing = np.gradient(position, time) - present
    far = np.isfinite(missing) & (np.abs(missing) > _JUMP * np.ptp(present))
    repeats = np.append(False, present[1:] == present[:-1])
    if far.sum() < _FEWEST or np.mean(repeats[far]) > _STILL:  # a register that wraps goes on counting
        return None
    period = _rounded(float(np.median(np.abs(missing[far]))), _quantum(present))
    if abs(period / np.ptp(present) - 1.0) > _FULL:
        return None
    turns = np.where(np.isfinite(missing), np.round(missing / period), 0.0)
    return present + period * turns, period


def _quantum(present: np.ndarray) -> float:
    """Return the step of a register, or zero if there is none.

    It is made more exact by ever greater numbers, each of which is a whole number of steps.
    """
    steps = np.diff(np.unique(present))
    if not len(steps):
        return 0.0
    step = float(np.quantile(steps, 0.1))
    step = float(np.median(steps[np.abs(steps - step) < _ALIKE * step]))
    for most in (1e2, 1e3, 1e4):
        small = present[np.abs(present) < most * step]
        counts = np.round(small / step)
        if not counts.any() or np.mean(np.abs(small / step - counts) < 2.0 * _ALIKE) < 0.9:
            break
        step = float((small * counts).sum() / (counts**2).sum())
    off = steps / step - np.round(steps / step)
    return step if np.mean(np.abs(off) < 2.0 * _ALIKE) > 0.9 else 0.0


def _rounded(size: float, quantum: float) -> float:
    """Return the turn, or the power of two of steps, that a size is near to; else the size itself."""
    wanted = [_TURN, 360.0, 1.0, 0.5 * _TURN]
    if quantum > 0.0 and size > quantum:
        wanted.insert(0, quantum * 2.0 ** round(float(np.log2(size / quantum))))
    near = [value for value in wanted if abs(size / value - 1.0) < _ROUNDING]
    return near[0] if near else size
