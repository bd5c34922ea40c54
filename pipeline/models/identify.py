"""Identification of nominal parameters, for every kind of platform."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from simgap.models.feedforward import Feedforward, identify_feedforward
from simgap.models.motor_samples import motors_of
from simgap.models.nominal_motor import nominal_feedforward
from simgap.models.parameters import WITHHELD
from simgap.models.quadrotor_parameters import identify_quadrotor
from simgap.models.rolling_radius import identify_rolling_radius
from simgap.models.settings import SystemIdentification
from simgap.platforms import Platform, Quadrotor, Swerve
from simgap.recordings.recording import Recording


@dataclass(frozen=True)
class Identified:
    """Parameters and how well their equations fit.

    Attributes:
        parameters: a tree of `Parameter`: by name, for motors by motor and name, and under `wheels` what is known of
            those of a swerve drive.
        metrics: by equation or motor, scores by name.
        warnings: doubts, one sentence each.
    """

    parameters: dict[str, Any] = field(default_factory=dict)
    metrics: dict[str, dict[str, float]] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def identify(
    recording: Recording, platform: Platform, settings: SystemIdentification, seed: int = 0
) -> Identified:
    """Identify the parameters of a platform from the runs that are not held out.

    Args:
        recording: cleaned, of the platform's kind.
        platform: what is known before.
        settings: of the identification.
        seed: of the draw of the blocks that score a motor.

    Raises:
        InputError: when the recording is too short, or `motors` does not fit its runs.
    """
    runs = [run for run in recording.runs if recording.split.get(run) != "holdout"]
    if isinstance(platform, Quadrotor) and "velocity_x" not in recording.frame:
        return Identified(
            warnings=("no velocity and attitude were recorded: drag and coefficients need them",)
        )
    if isinstance(platform, Quadrotor):
        found = identify_quadrotor(recording, platform, runs, settings)
        metrics = {name: {"explained": share} for name, share in found.explained.items()}
        return Identified(dict(found.parameters), metrics, tuple(_withheld(found.parameters.items())))
    if recording.kind == "joint" and "voltage" not in recording.units:
        return Identified(warnings=("no voltage was recorded: there is no motor to identify",))
    motors: dict[str, Feedforward] = {
        name: identify_feedforward(samples, settings, nominal_feedforward(platform, name), seed)
        for name, samples in motors_of(recording, runs, settings.motors, platform)
    }
    named = [(f"{key} of {name}", p) for name, motor in motors.items() for key, p in motor.parameters.items()]
    parameters: dict[str, Any] = {name: motor.parameters for name, motor in motors.items()}
    if isinstance(platform, Swerve):
        radius = identify_rolling_radius(recording, platform, runs, settings)
        parameters |= {"wheels": {"rolling_radius": radius}} if radius else {}
    return Identified(
        parameters=parameters,
        metrics={name: motor.scores for name, motor in motors.items() if motor.scores},
        warnings=tuple(_withheld(named)),
    )


def _withheld(parameters: Iterable[tuple[str, Any]]) -> Iterable[str]:
    """Say what this recording did not tell; what no recording can tell is no cause for doubt."""
    return (f"{name}: {p.note}" for name, p in parameters if p.note.startswith(WITHHELD))
