"""The feedforward gains of a motor that drives a joint: kS, kV and kA, as WPILib means them."""

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from simgap.errors import InputError

if TYPE_CHECKING:
    from simgap.models.identify import Identified
    from simgap.platforms import Platform
    from simgap.recordings.recording import Recording

_NEVER_NEGATIVE = ("kS", "kV", "kA")
"""Friction, back-EMF and inertia have a sign; the load kG may pull either way."""


def motor_gains(recording: "Recording", platform: "Platform", seed: int = 0) -> "Identified | None":
    """Return the gains of a joint's motor with their standard errors; None where no voltage drives it.

    Args:
        recording: cleaned.
        platform: what is known of the machine.
        seed: of the draw of the blocks that score the fit.
    """
    from simgap.models.identify import identify
    from simgap.models.settings import SystemIdentification

    if recording.kind != "joint" or "voltage" not in recording.units:
        return None
    try:
        # Gains are not scored on held-out runs, and need ramps and steps, whichever of them were held out.
        found = identify(replace(recording, split={}), platform, SystemIdentification(), seed)
    except InputError:  # too short for gains is no reason to give no answer
        return None
    return found if found.metrics else None


def write_gains(found: "Identified", folder: Path) -> None:
    """Write `parameters.yaml` and `metrics.json`, as the stage `sysid` does."""
    from simgap.models.parameters import write_parameters

    folder.mkdir()
    write_parameters(found.parameters, folder / "parameters.yaml")
    (folder / "metrics.json").write_text(json.dumps(found.metrics, indent=2) + "\n", encoding="utf-8")


def gains_line(found: "Identified") -> str:
    """Return the gains as one line for the terminal, with those that no motor can have."""
    from simgap.report.text import estimate, listed, with_unit

    gains = next(iter(found.parameters.values()))
    said = [
        f"{name} {with_unit(estimate(gain.value, gain.standard_error), gain.unit)}"
        for name, gain in gains.items()
        if gain.value is not None
    ]
    wrong = [name for name in _NEVER_NEGATIVE if name in gains and (gains[name].value or 0.0) < 0.0]
    doubt = f". No motor has {listed(wrong, 'or')} below zero: do not use these gains" if wrong else ""
    return f"feedforward gains of the motor: {', '.join(said)}{doubt}"
