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
    """What is known of the corners that a detector reports, and of the attitude that is believed meanwhile."""

    noise: float = 1.0  # px of the resized image, standard deviation of each coordinate
    tilt: float = 0.01  # rad about each axis, standard deviation of the odometry's attitude
    samples: int = 20  # perturbed sets of both from which a measurement's covariance is taken


@dataclass
class DriftSettings:
    """The diagonal of the drift's process noise, added at every step of the odometry, and what is believed of gates."""

    position: float = 0.05  # σ_pos, m²
    velocity: float = 0.1  # σ_vel, m²/s²
    taken: float = (
        0.999  # share of right positions from gates that are taken in; 1: all positions, false ones too
    )


@dataclass
class ImageSettings:
    """How images are taken, and of what but gates. Two numbers are the ends of a range from which each image draws."""

    period: float = 0.04  # s, from image to image
    exposures: int = (
        6  # instants within the shutter whose light is averaged; each looks at another part of a pixel
    )
    shutter: list[float] = field(default_factory=lambda: [0.002, 0.01])  # s
    blur: list[float] = field(default_factory=lambda: [0.0, 0.8])  # px, standard deviation of the lens's blur
    gain: list[float] = field(default_factory=lambda: [0.7, 1.4])
    vignetting: list[float] = field(
        default_factory=lambda: [0.0, 0.5]
    )  # light that a corner of the image lacks
    shot: list[float] = field(default_factory=lambda: [0.0, 0.02])  # noise of full light, over full light
    read: list[float] = field(default_factory=lambda: [0.0, 0.02])  # noise without light, over full light
    gate: list[float] = field(default_factory=lambda: [0.7, 1.0])  # brightness of gates
    clutter: int = 6  # panels in the background
    clutter_distance: list[float] = field(default_factory=lambda: [4.0, 30.0])  # m
    clutter_size: list[float] = field(default_factory=lambda: [0.05, 2.5])  # m, half a side
    covers: int = 2  # panels in the foreground
    cover_distance: list[float] = field(default_factory=lambda: [0.4, 2.0])  # m
    cover_size: list[float] = field(default_factory=lambda: [0.02, 0.2])  # m, half a side


@dataclass
class ViewSettings:
    """From where gates are seen in training, drawn anew for every image."""

    gates: int = 4  # in the world of an image
    opening: float = 1.5  # m, inner side of a gate
    frame: float = 0.3  # m, width of the frame around it
    distance: list[float] = field(default_factory=lambda: [1.0, 20.0])  # m, even in its logarithm
    aside: float = 1.4  # rad, greatest angle between a gate and the camera's axis
    askew: float = 1.3  # rad, greatest angle between the line of sight and a gate's normal
    tilt: float = 0.9  # rad, standard deviation of the angle between the body's z axis and the vertical
    speed: float = 20.0  # m/s, greatest
    rate: float = 4.0  # rad/s, standard deviation about each axis


@dataclass
class LearningSettings:
    """How a detector is trained."""

    batch: int = 16  # images
    steps: int = 200  # of an epoch
    epochs: int = 60
    validation: int = 8  # batches
    learning_rate: float = 4e-3  # greatest; it falls along a cosine
    corner: float = 300.0  # weight of the pixels of corners, over that of the others
    edge: float = 20.0  # weight of the pixels of edges, likewise


@dataclass
class DetectorSettings:
    """A network that finds corners, and how they are read off its maps."""

    filters: list[int] = field(default_factory=list)  # of each level
    kernels: list[int] = field(default_factory=list)  # px, of each level
    slope: float = 0.01  # of LeakyReLU below zero
    corner: float = 2.0  # px, standard deviation of a corner's bell in its map
    edge: float = 2.0  # px, half the width of an edge in its field
    peaks: int = 20  # of a map, at most
    least_peak: float = 0.45  # of a map
    least_edge: float = 0.45  # mean of the field along an edge
    delay: float = 0.0  # s, from an image to what is found in it, in the loop of a flight
    enabled: bool = False  # whether a branch trains one, and flies with it
    views: ViewSettings = field(default_factory=ViewSettings)
    learning: LearningSettings = field(default_factory=LearningSettings)


@dataclass
class PerceptionSettings:
    """The configuration group `perception`."""

    camera: CameraSettings = field(default_factory=CameraSettings)
    images: ImageSettings = field(default_factory=ImageSettings)
    detector: DetectorSettings = field(default_factory=DetectorSettings)
    corners: CornerSettings = field(default_factory=CornerSettings)
    drift: DriftSettings = field(default_factory=DriftSettings)
