"""The tracks of the project, as tests fly them."""

from pathlib import Path

from omegaconf import OmegaConf

from simgap.gates.settings import TrackSettings
from simgap.gates.track import Track, track_from

CONF = Path(__file__).parents[3] / "conf"


def track_settings(name: str) -> TrackSettings:
    merged = OmegaConf.merge(
        OmegaConf.structured(TrackSettings), OmegaConf.load(CONF / "track" / f"{name}.yaml")
    )
    settings = OmegaConf.to_object(merged)
    assert isinstance(settings, TrackSettings)
    return settings


def track_named(name: str) -> Track:
    return track_from(track_settings(name))
