"""simgap: from recordings of a real machine to a simulator that explains them.

    import simgap

    answer = simgap.diagnose("log.parquet", platform="arm.yaml")
    machine = answer.simulator
    states = machine.rollout(state, commands, dt=0.01)

Importing it is cheap: what a name needs is imported when the name is first used. It also makes Gymnasium know
`simgap/Race-v0`.
"""

from typing import TYPE_CHECKING

from simgap.api.registration import register_environments
from simgap.errors import InputError
from simgap.lazy import imported_late

if TYPE_CHECKING:
    from simgap.api.answer import Answer
    from simgap.api.diagnosing import diagnose
    from simgap.api.findings import (
        Ambiguity,
        Contradiction,
        Effect,
        Fit,
        Mismatch,
        Parameter,
        Regime,
        Size,
        Unnamed,
    )
    from simgap.api.inputs import load_recording
    from simgap.api.machine import Machine
    from simgap.api.memory import Memory
    from simgap.api.race import race
    from simgap.api.simulators import build_simulator, catalogue, load_simulator

_WHERE = {
    "api.answer": ("Answer",),
    "api.diagnosing": ("diagnose",),
    "api.findings": (
        "Ambiguity",
        "Contradiction",
        "Effect",
        "Fit",
        "Mismatch",
        "Parameter",
        "Regime",
        "Size",
        "Unnamed",
    ),
    "api.inputs": ("load_recording",),
    "api.machine": ("Machine",),
    "api.memory": ("Memory",),
    "api.race": ("race",),
    "api.simulators": ("build_simulator", "catalogue", "load_simulator"),
}

__all__ = [
    "Ambiguity",
    "Answer",
    "Contradiction",
    "Effect",
    "Fit",
    "InputError",
    "Machine",
    "Memory",
    "Mismatch",
    "Parameter",
    "Regime",
    "Size",
    "Unnamed",
    "build_simulator",
    "catalogue",
    "diagnose",
    "load_recording",
    "load_simulator",
    "race",
]


__getattr__ = imported_late(__name__, **_WHERE)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


register_environments()
