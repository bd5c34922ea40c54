"""The size of concealed effects in a benchmark case, set so that the case is as clear or faint as its category."""

from dataclasses import replace
from functools import partial
from typing import Any

from simgap.stages._prove_settings import ProveStage


def settled(case: Any, config: ProveStage) -> tuple[Any, dict[str, float]]:
    """Scale the effects of a case to the size that its category demands.

    Args:
        case: of `draw_cases`, its effects at their usual strength.
        config: of the stages.

    Returns:
        The case, and per effect the energy that it adds to the residual, divided by the noise energy.
    """
    from simgap.benchmark.strength import settle_strength

    energies = {}
    for effect in case.effects:
        energy_of = partial(_energy_of, case.shown, effect, config)
        strength, energies[effect] = settle_strength(energy_of, case.subject.strength)
        case = case.scaled(effect, strength)
    return case, energies


def _energy_of(case: Any, effect: str, config: ProveStage, strength: float) -> float:
    return energy_over_noise(case.scaled(effect, strength), effect, config)


def energy_over_noise(case: Any, effect: str, config: ProveStage) -> float:
    """Return the energy that an effect explains over the noise energy, in the channel where it explains most.

    Two simulators are compared on one recording: one with all concealed effects, one without this effect. What is
    within tolerance counts as zero, since the diagnosis does not name it: a delay that is shorter than the sampling can
    show, a number of the platform that is off by less than a fit can tell.
    """
    from simgap.effects import effect_by_key
    from simgap.equations.residuals import residual_rows
    from simgap.equations.row_noise import noise_of_rows
    from simgap.gap.hypothesis import is_tolerance
    from simgap.gap.reading import likeliest_reading
    from simgap.platforms.settings import SimulatorSettings
    from simgap.recordings.cleaning import clean_with_coverage
    from simgap.simulation import FittedEffect
    from simgap.simulation.build import build_simulator
    from simgap.stages.record import record_drawn

    recording, key = record_drawn(case)
    cleaned = clean_with_coverage(recording, config.clean, config.dataset.split, case.seed).recording
    known = _known(case.kind, key)
    whole = build_simulator(case.platform, SimulatorSettings(effects=known), cleaned.units)
    reading = likeliest_reading(cleaned, whole, replace(config.gap, effects=[]))
    blocks, functions = reading.problem.blocks, reading.problem.functions
    without = {name: values for name, values in known.items() if not _is_of(name, effect)}
    simulators = [
        replace(
            build_simulator(case.platform, SimulatorSettings(effects=effects), cleaned.units),
            settings=reading.nominal.settings,
        )
        for effects in (known, without)
    ]
    mine = tuple(FittedEffect(effect_by_key(case.kind, k), v) for k, v in known.items() if _is_of(k, effect))
    found = simulators[1].with_effects((*simulators[1].effects, *mine))
    if any(is_tolerance(fitted, found, reading) for fitted in mine):
        return 0.0
    noise = noise_of_rows(simulators[0], blocks, functions)
    complete, lacking = (
        (residual_rows(simulator, blocks, functions) / noise).square().mean((0, 1))
        for simulator in simulators
    )
    return float((lacking - complete).max())


def _known(kind: str, key: dict[str, Any]) -> dict[str, dict[str, float]]:
    """Return the parameter values of an answer key, by the catalogue's key of each effect."""
    from simgap.benchmark.score import effect_name

    known = {}
    for effect in key["effects"]:
        values = {name: entry["value"] for name, entry in effect["parameters"].items()}
        known[_key_of(kind, effect_name(effect), values)] = values
    return known


def _key_of(kind: str, name: str, values: dict[str, float]) -> str:
    """Return the catalogue's key of a concealed effect: one name may stand for each of four rotors."""
    from simgap.effects import effects_of

    alike = [effect for effect in effects_of(kind) if _is_of(effect.key, name)]
    return next(e.key for e in alike if set(values) <= {parameter.name for parameter in e.parameters})


def _is_of(key: str, name: str) -> bool:
    return key == name or key.partition("@")[0] == name
