"""Configuration of perception; `conf/perception/default.yaml` says where each number comes from."""

from dataclasses import dataclass, field


@dataclass
class CameraSettings:
    """A camera, as its maker calibrated it, and where it is mounted."""

    lens: str = "fisheye"  # or pinhole
    sensor: list[int] = field(default_factory=list)  # px, width and height that the calibration is for
    focal: list[float] = field(default_factory=list)  # px
    centre: list[float] = field(default_factory=list)  # px
    distortion: list[float] = field(default_factory=list)  # k1, k2 and so on of a fisheye
    field_of_view: float = 1.5  # rad, of the cone in which the lens draws
    image: list[int] = field(default_factory=list)  # px, width and height that images are resized to
    pitch: float = 0.35  # rad by which it looks up from the body's x axis
    position: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])  # m, on the body


@dataclass
class CornerSettings:
    """What is known of the corners that a detector reports."""

    noise: float = 1.0  # px of the resized image, standard deviation of each coordinate
    samples: int = 20  # perturbed sets of corners from which a measurement's covariance is taken


@dataclass
class DriftSettings:
    """The diagonal of the drift's process noise, added at every step of the odometry."""

    position: float = 0.05  # σ_pos, m²
    velocity: float = 0.1  # σ_vel, m²/s²


@dataclass
class PerceptionSettings:
    """The configuration group `perception`."""

    camera: CameraSettings = field(default_factory=CameraSettings)
    corners: CornerSettings = field(default_factory=CornerSettings)
    drift: DriftSettings = field(default_factory=DriftSettings)
