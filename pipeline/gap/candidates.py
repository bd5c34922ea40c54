"""The effects of the catalogue that a recording allows to test."""

from collections.abc import Mapping, Sequence

from torch import Tensor

from simgap.effects import Effect, effect_by_key, effects_of
from simgap.simulation import Simulator


def candidates_for(
    simulator: Simulator, signals: Mapping[str, Tensor], names: Sequence[str] | None
) -> list[Effect]:
    """Return the effects of the catalogue that this recording allows to test.

    Raises:
        InputError: when `names` holds an effect that the catalogue does not have.
    """
    recorded = available_signals(signals)
    constants = simulator.constants()
    return [
        effect
        for effect in allowed(simulator.platform.kind, names)
        if set(effect.needs) <= recorded
        and recorded.isdisjoint(effect.excluded_by)
        and effect.fits(constants)
    ]


def allowed(kind: str, names: Sequence[str] | None) -> list[Effect]:
    """Return the effects of a kind that may be named, of all or of some names.

    Raises:
        InputError: when `names` holds an effect that the catalogue does not have.
    """
    for wanted in names or ():
        if wanted not in {effect.name for effect in effects_of(kind)}:
            effect_by_key(kind, wanted)
    chosen = [e for e in effects_of(kind) if names is None or {e.name, e.key} & set(names)]
    return [effect for effect in chosen if effect.names_physics]


def available_signals(signals: Mapping[str, Tensor]) -> set[str]:
    """Return the recorded signals and those that a nominal actuator derives from them."""
    made = {"motor_command": "rotor_speed", "voltage": "effort", "position_command": "effort"}
    return set(signals) | {product for source, product in made.items() if source in signals}
