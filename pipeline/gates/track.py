"""A track: gates in the order in which they are to be passed, and the box that is not to be left."""

from dataclasses import dataclass
from functools import cached_property

import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.gates.settings import GateSettings, TrackSettings

_REMEDY = "see conf/track for examples"


@dataclass(frozen=True)
class Track:
    """Gates as tensors.

    Attributes:
        centres: (gates, 3) m.
        axes: (gates, 3, 3): rows are the direction of passing, left and up.
        opening: inner side, m.
        frame: width of the frame, m.
        clearance: of the machine's middle, m.
        box: (2, 3): least and greatest coordinates, m.
    """

    centres: Tensor
    axes: Tensor
    opening: float
    frame: float
    clearance: float
    box: Tensor

    def __len__(self) -> int:
        return len(self.centres)

    @cached_property
    def corners(self) -> Tensor:
        """Corners of the openings, (gates, 4, 3) m: left up, right up, right down, left down as one flies at them.

        Of several tracks at once, whose centres and axes have further dimensions in front, so have the corners.
        """
        sides = torch.tensor([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]).to(self.centres)
        return self.centres[..., None, :] + 0.5 * self.opening * sides @ self.axes[..., 1:, :]

    @property
    def length(self) -> float:
        """Of a lap along straight lines from gate to gate, m."""
        return float((self.centres - self.centres.roll(1, 0)).norm(dim=-1).sum())

    def to(self, target: torch.device | torch.dtype | str) -> "Track":
        """Return the track on a device, or in another precision."""
        tensors = (self.centres.to(target), self.axes.to(target))
        return Track(*tensors, self.opening, self.frame, self.clearance, self.box.to(target))

    def outside(self, position: Tensor) -> Tensor:
        """Return whether machines at a position (batch, 3) have left the box or hit the ground, (batch,) bool."""
        low, high = self.box[0] + self.clearance, self.box[1] - self.clearance
        return ~((position > low) & (position < high)).all(-1)


def track_from(settings: TrackSettings) -> Track:
    """Build a track from its configuration.

    Raises:
        InputError: on fewer than two gates, a gate without direction, outside the box or too small for the machine.
    """
    where = f"track {settings.name}".strip()
    if len(settings.gates) < 2:
        raise InputError("has fewer than two gates", where, _REMEDY)
    if settings.opening <= 2.0 * settings.clearance:
        raise InputError("leaves no room inside its gates", where, "make opening larger or clearance smaller")
    if [len(corner) for corner in settings.box] != [3, 3]:
        raise InputError("needs two corners of a box, each [x, y, z]", f"{where}: box", _REMEDY)
    centres = [_centre(gate, f"{where}: gate {number}") for number, gate in enumerate(settings.gates, 1)]
    axes = [_axes(gate, f"{where}: gate {number}") for number, gate in enumerate(settings.gates, 1)]
    track = Track(
        torch.tensor(centres),
        torch.stack(axes),
        settings.opening,
        settings.frame,
        settings.clearance,
        torch.tensor(settings.box),
    )
    for number, outside in enumerate(track.outside(track.centres).tolist(), 1):
        if outside:
            raise InputError("is outside the box", f"{where}: gate {number}", "make the box larger")
    return track


def _centre(gate: GateSettings, where: str) -> list[float]:
    if len(gate.position) != 3:
        raise InputError("its position is not [x, y, z]", where, _REMEDY)
    return [float(number) for number in gate.position]


def _axes(gate: GateSettings, where: str) -> Tensor:
    direction = torch.tensor([float(number) for number in gate.direction])
    if len(direction) != 2 or not float(direction.norm()) > 0:
        raise InputError("its direction is not [x, y]", where, _REMEDY)
    x, y = (direction / direction.norm()).tolist()
    return torch.tensor([[x, y, 0.0], [-y, x, 0.0], [0.0, 0.0, 1.0]])
