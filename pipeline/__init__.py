"""simgap: from recordings of a real machine to a simulator that explains them.

    import simgap

    answer = simgap.diagnose("log.parquet", platform="arm.yaml")
    machine = answer.simulator
    states = machine.rollout(state, commands, dt=0.01)

Importing it is cheap: what a name needs is imported when the name is first used. It also makes Gymnasium know
`simgap/Race-v0`.
"""

import importlib
from typing import TYPE_CHECKING, Any

from simgap.api.registration import register_environments
from simgap.errors import InputError

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
    "simgap.api.answer": ("Answer",),
    "simgap.api.diagnosing": ("diagnose",),
    "simgap.api.findings": (
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
    "simgap.api.inputs": ("load_recording",),
    "simgap.api.machine": ("Machine",),
    "simgap.api.memory": ("Memory",),
    "simgap.api.race": ("race",),
    "simgap.api.simulators": ("build_simulator", "catalogue", "load_simulator"),
}
_MODULE_OF = {name: module for module, names in _WHERE.items() for name in names}

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


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'simgap' has no attribute {name!r}")
    value = getattr(importlib.import_module(_MODULE_OF[name]), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


register_environments()
