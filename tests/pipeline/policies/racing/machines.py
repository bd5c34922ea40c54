"""A racer on the tracks of the project, as tests fly it."""

from functools import cache

import yaml

from simgap.platforms import Quadrotor, platform_from_config
from simgap.policies.racing.flying import flight_in
from simgap.policies.racing.racing import Misjudging, Racing
from simgap.policies.racing.settings import Flying, RacingSettings
from simgap.simulation import Simulator
from tests.pipeline.gates.tracks import CONF, track_named

# Fewer and simpler inner steps than a race has: they are compiled sooner.
COARSE = Flying(substeps=2, integrator="euler", rate=6.0, yaw_rate=3.0)


@cache
def racer() -> Quadrotor:
    platform = platform_from_config(yaml.safe_load((CONF / "platform" / "racer.yaml").read_text()))
    assert isinstance(platform, Quadrotor)
    return platform


def racing(
    batch: int,
    track: str = "tiny",
    settings: RacingSettings | None = None,
    misjudging: Misjudging | None = None,
) -> Racing:
    settings = settings or RacingSettings(flying=COARSE)
    flight = flight_in(Simulator(racer()), settings.flying)
    return Racing(flight, track_named(track), settings, batch, misjudging=misjudging)
