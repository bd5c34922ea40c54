"""Where the fit of an effect starts, in the sizes of the recording."""

from simgap.effects import Effect
from simgap.gap.scales import Scales
from simgap.simulation.blocks import Blocks

_SHARES = (0.1, 0.5, 1.5)
_SHAPES = (0.1, 0.3, 1.0, 3.0)


def starts_of(effect: Effect, blocks: Blocks, scales: Scales) -> list[dict[str, float]]:
    """Return values from which to start: the effect's own scan, its sizes measured in those of the recording.

    A scan over absolute sizes works in the unit that it was written for: in newtons it misses what it finds in kilonewtons.
    """
    own = effect.starts_in(blocks.signals | blocks.resolution)
    sizes = {p.name: scales.of(p.unit) for p in effect.parameters}
    scanned = {name for name in sizes if len({start[name] for start in own}) > 1}
    if len(own) == 1 or len(sizes) != 2 or scanned != set(sizes) or None in sizes.values():
        return own
    (first, size), (second, shape) = sizes.items()
    assert size is not None and shape is not None
    return [{first: share * size, second: part * shape} for share in _SHARES for part in _SHAPES]
