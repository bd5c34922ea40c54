"""A race as a Gymnasium environment: `simgap/Race-v0`."""

import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.api.inputs import read_option, settings_of
from simgap.extras import named_extras

if TYPE_CHECKING:
    from simgap.api.inputs import PlatformLike
    from simgap.api.machine import Machine
    from simgap.policies.gymnasium_adapter import GymnasiumEnvironment
    from simgap.simulation import Simulator

    SimulatorLike = Machine | PlatformLike
    TrackLike = str | Path | Mapping[str, Any]

ID = "simgap/Race-v0"


def race(
    simulator: "SimulatorLike" = "racer",
    track: "TrackLike" = "figure_eight",
    settings: Mapping[str, Any] | None = None,
    render_mode: None = None,
) -> "GymnasiumEnvironment":
    """Make the environment of one quadrotor that races through gates; `gymnasium.make("simgap/Race-v0", ...)` calls it.

    An action is (4,) float32 within ±1: collective thrust over mass, then body rates about x, y and z. Zero hovers; one
    is 35 m/s², 10 rad/s, 10 rad/s and 4 rad/s unless `settings` say otherwise. An observation is (31,) float32:
    position / 10 m and velocity / 10 m/s in the world frame, the rotation from body to world row by row, the corners
    of the next gate as seen from the machine, in the body frame / 10 m, and the action before. A step lasts 0.01 s.

    The reward is that of Kaufmann et al. 2023 (Nature 620): progress, sight of the gate, smooth commands. An episode
    ends with a crash or a missed gate, and is cut off after `settings.episode_steps` steps. The first step compiles
    the simulator. An effect that cannot be flown, since nothing says what drives it, is left out with a warning.

    Args:
        simulator: the folder of a simulator (or of the answer around it), a `Machine`, or a platform as
            `simgap.diagnose` takes it, which is flown as its nominal equations say.
        track: the name of a track that the package brings (`figure_eight`, `split_s`, `tiny`), the path of a YAML file,
            or a mapping of its keys.
        settings: what differs from the configuration group `train_policy`, key `racing`, for example
            `{"flying": {"powertrain": False}}` for a simulator whose motors were diagnosed.
        render_mode: there is none.

    Raises:
        InputError: when the simulator is not of a quadrotor, the track cannot be flown, a setting is unknown, or what
            racing needs is not installed.
    """
    with named_extras():
        from simgap.gates.settings import TrackSettings
        from simgap.policies.gymnasium_adapter import GymnasiumEnvironment
        from simgap.policies.racing.entry import race_in
        from simgap.policies.racing.flying import left_out
        from simgap.policies.racing.settings import RacingSettings
    gates = settings_of(TrackSettings, _track(track), "track")
    chosen = settings_of(RacingSettings, settings or {}, "settings")
    machine = _simulator(simulator)
    for effect in left_out(machine, chosen.flying):
        warnings.warn(effect, stacklevel=2)
    return GymnasiumEnvironment(race_in(machine, gates, chosen, 1))


def _simulator(chosen: "SimulatorLike") -> "Simulator":
    from simgap.api.machine import Machine
    from simgap.api.simulators import build_simulator, load_simulator

    if isinstance(chosen, Machine):
        return chosen.simulator
    if isinstance(chosen, str | Path) and Path(chosen).expanduser().is_dir():
        return load_simulator(chosen).simulator
    return build_simulator(chosen).simulator


def _track(chosen: "TrackLike") -> Mapping[str, Any]:
    return chosen if isinstance(chosen, Mapping) else read_option("track", chosen)
