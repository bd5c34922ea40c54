"""Configuration of a track."""

from dataclasses import dataclass, field


@dataclass
class GateSettings:
    """A square gate, upright.

    Attributes:
        position: of its middle, world frame, m.
        direction: in which it is to be passed, x and y of the world frame, of any length.
    """

    position: list[float] = field(default_factory=list)
    direction: list[float] = field(default_factory=list)


@dataclass
class TrackSettings:
    """The configuration group `track`."""

    name: str = ""
    gates: list[GateSettings] = field(default_factory=list)
    opening: float = 1.5  # m, inner side of a gate
    frame: float = 0.3  # m, width of the frame around the opening
    clearance: float = 0.15  # m, to be kept between the machine's middle and a frame, the ground and the box
    box: list[list[float]] = field(
        default_factory=list
    )  # m, least and greatest x, y, z; the least z is the ground
