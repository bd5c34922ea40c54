"""What takes the drift off odometry in a race: gates by their distance, or images that a detector reads."""

from pathlib import Path
from typing import TYPE_CHECKING

from simgap.errors import InputError
from simgap.gates.settings import TrackSettings
from simgap.perception.settings import PerceptionSettings
from simgap.policies.settings import Deployment
from simgap.runner import StageConfig, StageRun

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from simgap.perception.chain import Chain


def detector_folder(chosen: Deployment, perception: PerceptionSettings, config: StageConfig) -> Path | None:
    """Return the folder of the detector to fly with: one that is named, or that of the branch where it asks for one.

    Raises:
        InputError: when one is named, although gates are not to be looked for.
    """
    if chosen.detector and not chosen.gates:
        raise InputError("is given, but deploy.gates is false", "deploy.detector", "leave one of them out")
    if chosen.detector:
        return Path(chosen.detector)
    asked = chosen.gates and perception.detector.enabled
    return config.artifact("train_detector", "detector") if asked else None


def distances_seen(
    perception: PerceptionSettings, settings: TrackSettings
) -> "Callable[[NDArray[np.float64]], NDArray[np.float64]]":
    """Return how to find, from states (runs, 13), the distances of the gates in view, (runs, gates) m.

    Raises:
        InputError: on a camera or a track that cannot be.
    """
    import torch

    from simgap.gates.track import track_from
    from simgap.perception.camera import camera_from
    from simgap.perception.view import distances

    camera, track = camera_from(perception.camera), track_from(settings).to(torch.float64)

    def look(states: "NDArray[np.float64]") -> "NDArray[np.float64]":
        position, _, attitude, _ = torch.from_numpy(states).split([3, 3, 4, 3], dim=1)
        return distances(camera, track, position, attitude).numpy()

    return look


def chain_through(
    folder: Path,
    perception: PerceptionSettings,
    settings: TrackSettings,
    machines: int,
    step: float,
    config: StageConfig,
    run: StageRun,
) -> "Chain":
    """Return the chain from images to estimates, with a trained detector.

    Args:
        folder: of the detector.
        perception: camera, images, and how they are read.
        settings: of the track.
        machines: how many.
        step: of the odometry, s.
        config: of the stage.
        run: of the stage.

    Raises:
        InputError: when there is no detector, when it was trained with another camera, or the track cannot be.
    """
    import torch

    from simgap.gates.track import track_from
    from simgap.perception.chain import Chain
    from simgap.perception.eye import Eye, Eyes
    from simgap.perception.storage import load_detector

    track = track_from(settings)
    network, trained = load_detector(run.input(folder))
    if trained.camera != perception.camera:
        remedy = "leave perception.camera as it was, or train a detector for this one"
        raise InputError("was trained with another camera", str(folder), remedy)
    eye = Eye(network, perception, "cuda" if torch.cuda.is_available() else "cpu")
    return Chain(Eyes(eye, track, config.seed), perception, track, machines, step, config.seed)
