"""A racer and the tracks of the project, as tests fly them."""

from functools import cache
from pathlib import Path

import yaml
from omegaconf import OmegaConf

from simgap.platforms import Quadrotor, platform_from_config
from simgap.policies.racing.flying import flight_in
from simgap.policies.racing.racing import Misjudging, Racing
from simgap.policies.racing.settings import Flying, RacingSettings, TrackSettings
from simgap.policies.racing.track import Track, track_from
from simgap.simulation import Simulator

CONF = Path(__file__).parents[4] / "conf"
# Fewer and simpler inner steps than a race has: they are compiled sooner.
COARSE = Flying(substeps=2, integrator="euler", rate=6.0, yaw_rate=3.0)


@cache
def racer() -> Quadrotor:
    platform = platform_from_config(yaml.safe_load((CONF / "platform" / "racer.yaml").read_text()))
    assert isinstance(platform, Quadrotor)
    return platform


def track_settings(name: str) -> TrackSettings:
    merged = OmegaConf.merge(
        OmegaConf.structured(TrackSettings), OmegaConf.load(CONF / "track" / f"{name}.yaml")
    )
    settings = OmegaConf.to_object(merged)
    assert isinstance(settings, TrackSettings)
    return settings


def track_named(name: str) -> Track:
    return track_from(track_settings(name))


def racing(
    batch: int,
    track: str = "tiny",
    settings: RacingSettings | None = None,
    misjudging: Misjudging | None = None,
) -> Racing:
    settings = settings or RacingSettings(flying=COARSE)
    flight = flight_in(Simulator(racer()), settings.flying)
    return Racing(flight, track_named(track), settings, batch, misjudging=misjudging)
