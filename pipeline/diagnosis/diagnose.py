"""From a cleaned recording and a nominal simulator to a diagnosis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import torch
from torch import Tensor

from simgap.consistency import check
from simgap.consistency.checked import Checked
from simgap.diagnosis.coarseness import coarse_axes, coarseness_of
from simgap.diagnosis.drift import drifts_of
from simgap.diagnosis.horizon import HorizonError, horizon_errors
from simgap.diagnosis.learned import LearnedResidual, learn, learned_rows
from simgap.diagnosis.locate import Mismatch, locate
from simgap.diagnosis.observable import observable, unjudged
from simgap.diagnosis.regimes import Regime, regimes_of
from simgap.diagnosis.rollout_fit import refit_through_rollouts
from simgap.diagnosis.unnamed import Unnamed, find_unnamed
from simgap.diagnosis.validate import Validation, validate
from simgap.diagnosis.whiteness import Memory, memories_of, remembered
from simgap.effects import MeasurementEffect, ParameterError
from simgap.equations.fit import channels_of, excess_of
from simgap.equations.problem import Problem
from simgap.equations.residuals import channels_on
from simgap.equations.row_noise import noise_of_rows
from simgap.equations.scoring import cross_validated, folds_of
from simgap.equations.trend import Trend
from simgap.gap.confusion import told_apart
from simgap.gap.gains import folded, with_gains
from simgap.gap.limits import at_limits, excessive_thrust, gains_said
from simgap.gap.name import Naming, name
from simgap.gap.reading import readings_of
from simgap.gap.settings import BELIEVED, BEYOND_NOISE, Gap
from simgap.gap.tolerated import within_tolerance
from simgap.platforms.mechanism import Channel
from simgap.recordings.contradiction import Contradiction
from simgap.recordings.doubts import SINGLE_RUN
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks
from simgap.simulation.driver import with_drivers

_SHORT = 10.0  # s, below which a warning says that the recording is short
_NOTABLE_SHARE = 0.1  # of the energy that was left before
_NEVER_FITTED = "no fitted run contains such motion; record more runs like them"
REFUTED = "held-out runs refute"
"""How warnings begin that speak against the answer."""
_LAW_FAILS = "an unknown effect, or a law that holds only approximately, is stronger there"


@dataclass(frozen=True)
class Diagnosis:
    """The result of `diagnose`.

    Attributes:
        verdict: `missing_physics`, `parameter_mismatch`, `none`, `unexplained` or `contradiction`.
        contradictions: of the recording with itself or the platform; nothing is named where there are any.
        warnings: doubts about recording and result.
        mismatches: where the nominal simulator fails.
        naming: the search for effects and its result.
        unnamed: formulas for what no effect of the catalogue explains.
        learned: residuals learned from recorded windows; they predict, but explain nothing.
        memories: correlations of the remaining residual with its past and with past inputs.
        validation: errors before and after on held-out runs.
        horizons: errors of open-loop predictions.
        fitting: the problem that was fitted.
        proving: the blocks used for validation.
        nominal: the simulator before.
        simulator: the simulator after.
    """

    verdict: str
    contradictions: tuple[Contradiction, ...]
    warnings: tuple[str, ...]
    mismatches: list[Mismatch]
    naming: Naming
    unnamed: list[Unnamed]
    learned: list[LearnedResidual]
    memories: list[Memory]
    validation: Validation
    horizons: list[HorizonError]
    fitting: Problem
    proving: Blocks
    nominal: Simulator
    simulator: Simulator

    @property
    def probabilities(self) -> dict[str, float]:
        """The probability of each named effect, by key."""
        return {named.effect.key: named.probability for named in self.naming.named}

    @property
    def channels(self) -> tuple[Channel, ...]:
        """The equations that the recording was held against."""
        return channels_on(self.nominal, self.fitting.blocks)


def diagnose(
    recording: Recording,
    nominal: Simulator,
    settings: Gap,
    checked: Checked | None = None,
) -> Diagnosis:
    """Locate the mismatch between a recording and a simulator, name the missing effects, fit and validate them.

    Args:
        recording: cleaned, with its runs divided into train, validation and hold-out.
        nominal: what is believed before.
        settings: of the gap engine.
        checked: what contradicts itself or the platform in the raw recording; without it, the cleaned one is checked.
            Nothing is named beside a contradiction.

    Raises:
        InputError: when the recording is too short or of another kind than the platform, or a setting out of its range.
    """
    settings.check()
    nominal, aside = observable(recording, with_gains(recording, nominal, settings))
    readings = readings_of(recording, nominal, settings)
    checked = checked or check(recording, nominal.platform)
    contradicted = checked.contradictions or tuple(excessive_thrust(readings[0].prepared))
    if contradicted:
        readings = [replace(reading, catalogue=()) for reading in readings]
    naming = name(readings, settings)
    first = naming.best.reading.problem
    naming, undecided = told_apart(naming, _remains(_in_units(naming, first), first))
    naming = naming.doubted(checked.doubt)
    prepared = naming.best.reading.prepared
    nominal, problem, proving = prepared.nominal, prepared.problem, prepared.proving
    fitted, functions, held_out = problem.blocks, problem.functions, prepared.held_out
    refitted, _ = refit_through_rollouts(naming.fit, problem, settings.fit_horizon, settings.folds)
    naming, simulator = _in_units(replace(naming, fit=refitted), problem), refitted.simulator
    problem = replace(
        problem, noise=torch.minimum(problem.noise, noise_of_rows(simulator, fitted, functions))
    )
    channels, regimes = channels_on(nominal, fitted), acting_regimes(fitted, simulator)
    mismatches = locate(naming.base.residual, channels, regimes_on(fitted, simulator), problem)
    fold = folds_of(fitted, settings.folds)
    residual = cross_validated(naming.fit, fold)
    unnamed = find_unnamed(
        residual, naming.base.residual, channels, regimes, problem, fold, settings.least_share
    )
    memories = memories_of(residual, channels, problem)
    learned = learn(residual, channels, regimes, problem, fold)
    beside = learned_rows(learned, channels, acting_regimes(proving, simulator), functions)
    counted = _counted(naming, mismatches, channels)
    validation = validate(
        nominal, simulator, proving, functions, counted, held_out, settings.resamples, beside
    )
    gap = bool(unnamed) or _is_gap(naming, problem)
    refuted = (*_refuted(naming, validation), *_held_out_only(validation, naming, problem, channels))
    on_limit = at_limits(naming.best.fit.simulator)
    doubts = (
        *unjudged(aside),
        *_unfinished(naming, settings),
        *gains_said(folded(simulator), nominal, on_limit),
        *undecided,
        *within_tolerance(naming, fitted.time_step),
        *on_limit,
        *_part(problem),
        *_changing(naming),
        *untouched(naming, mismatches, [*counted, *(each.channel for each in unnamed)]),
        *_shortness(problem),
        *coarseness_of(coarse_axes(naming.fit, problem, channels), fitted.time_step),
        *_doubts(naming, problem, () if contradicted else memories, held_out),
    )
    said = [contradiction.sentence for contradiction in contradicted]
    # A single run is a doubt of the fit, which says what follows from it.
    recorded = [warning for warning in recording.warnings if held_out or warning != SINGLE_RUN]
    warnings = dict.fromkeys((*said, *checked.warnings, *refuted, *recorded, *prepared.remarks, *doubts))
    return Diagnosis(
        verdict="contradiction" if contradicted else _verdict(naming, gap, _remains(naming, problem)),
        contradictions=contradicted,
        warnings=tuple(warnings),
        mismatches=mismatches,
        naming=naming,
        unnamed=[] if contradicted else unnamed,
        learned=learned,
        memories=memories,
        validation=validation,
        horizons=horizon_errors(nominal, simulator, proving, settings.horizon, settings.resamples),
        fitting=problem,
        proving=proving,
        nominal=nominal,
        simulator=folded(with_drivers(simulator.with_effects((*aside, *simulator.effects)), fitted.signals)),
    )


def _in_units(naming: Naming, problem: Problem) -> Naming:
    """Return what was named with the rows of its fit in the units of the channels.

    A fit has them on the side of the commands, see `simgap.equations.command_gain`, in which no one thinks.
    """
    fit, factor = naming.fit, problem.factor(naming.fit.simulator)
    residual, jacobian = fit.residual / factor, fit.jacobian / factor[:, None]
    return replace(naming, fit=replace(fit, residual=residual, jacobian=jacobian, scale=fit.scale / factor))


def regimes_on(blocks: Blocks, simulator: Simulator) -> list[Regime]:
    """Return the regime variables as a person knows them: as recorded, or as the simulator makes what was not.

    An effect of the simulator may scale or delay a command; the blocks come without their margins.
    """
    acting = simulator.along_time(blocks.signals, blocks.time_step)
    return _inner_regimes({**acting, **blocks.signals}, blocks, simulator)


def acting_regimes(blocks: Blocks, simulator: Simulator) -> list[Regime]:
    """Return the regime variables as they act in the simulator, on the blocks without their margins."""
    return _inner_regimes(simulator.along_time(blocks.signals, blocks.time_step), blocks, simulator)


def _inner_regimes(signals: Mapping[str, Tensor], blocks: Blocks, simulator: Simulator) -> list[Regime]:
    inner = {name: blocks.inner(series) for name, series in signals.items()}
    return regimes_of(simulator.platform.kind, inner, simulator.position_unit)


def _counted(naming: Naming, mismatches: Sequence[Mismatch], channels: Sequence[Channel]) -> list[Channel]:
    """Return the channels that enter the metric: those that the named effects act on, else where it fails."""
    inside = [named.effect for named in naming.named if named.effect.key in naming.best.keys]
    touched = {index for effect in inside for index in channels_of(naming.fit, effect)}
    counted = [channels[index] for index in sorted(touched)] or list(channels)
    failing = {mismatch.channel.name for mismatch in mismatches}
    return [channel for channel in counted if channel.name in failing] or counted


def _verdict(naming: Naming, gap: bool, remains: bool) -> str:
    """Return the verdict; a gap that no believed effect explains is `unexplained`.

    Args:
        naming: the named effects.
        gap: whether there is a gap.
        remains: whether much of it remains beside the named effects.
    """
    if not naming.named:
        return "unexplained" if gap else "none"
    if naming.sound < BELIEVED:
        return "unexplained"
    physics = [named for named in naming.named if not isinstance(named.effect, ParameterError)]
    if not remains:
        return "missing_physics" if physics else "parameter_mismatch"
    believed = any(named.probability >= BELIEVED for named in physics)
    return "missing_physics" if believed else "unexplained"


def _is_gap(naming: Naming, problem: Problem) -> bool:
    """Whether the nominal simulator fails somewhere, beyond what timing and platform numbers are known to."""
    believed_before = naming.base if naming.best.names else naming.fit
    return bool((excess_of(believed_before, problem.noise) > BEYOND_NOISE).any())


def _remains(naming: Naming, problem: Problem) -> bool:
    """Whether some channel still leaves much of the gap."""
    before, after = (excess_of(each, problem.noise) for each in (naming.base, naming.fit))
    return bool(((after > BEYOND_NOISE) & (after > _NOTABLE_SHARE * before)).any())


def _held_out_only(
    validation: Validation, naming: Naming, problem: Problem, channels: Sequence[Channel]
) -> list[str]:
    """Return a warning for each channel in which held-out runs show what no fitted run does."""
    _, after, noise = validation.channels.square().unbind(1)
    fitted = excess_of(naming.fit, problem.noise).clamp_min(1.0)
    return [
        f"{REFUTED} the answer in {channel.name}: their error energy is {proved:.2g} times the noise, that of the "
        f"fitted runs {known:.2g} times; {_LAW_FAILS if known > BEYOND_NOISE else _NEVER_FITTED}"
        for channel, proved, known in zip(channels, (after / noise).tolist(), fitted.tolist(), strict=True)
        if proved > BEYOND_NOISE * known
    ]


def _refuted(naming: Naming, validation: Validation) -> list[str]:
    """Return a warning if the held-out runs refute the named effects."""
    if not (naming.named and validation.refutes):
        return []
    return [
        f"{REFUTED} the named effects, with which their prediction becomes worse: do not rely on them; record more "
        "runs that resemble each other"
    ]


def _unfinished(naming: Naming, settings: Gap) -> list[str]:
    """Return a warning if the search did not come to its end."""
    if naming.complete:
        return []
    return [
        f"the search was ended before it was complete; this is the best answer so far (gap.budget={settings.budget:g})"
    ]


def _shortness(problem: Problem) -> list[str]:
    """Return a sentence about a recording that is too short for many names."""
    seconds = len(problem.blocks) * problem.blocks.samples * problem.blocks.time_step
    if seconds >= _SHORT:
        return []
    return [f"only {seconds:.3g} s could be fitted; record more than {_SHORT:g} s"]


def _part(problem: Problem) -> list[str]:
    """Return what a person has to know of a simulator whose effects do not act in the whole recording."""
    if problem.presence is None:
        return []
    names = " and ".join(key.partition("@")[0].replace("_", " ") for key in problem.presence.keys)
    acts = "acts" if len(problem.presence.keys) == 1 else "act"
    return [
        f"{names} {acts} in a part of the recording, and the simulator is that of the machine then; for the machine at "
        "other times, diagnose the other runs by themselves"
    ]


def _changing(naming: Naming) -> list[str]:
    """Return what a person has to know of a machine that changes slowly."""
    trend = naming.posterior.best.reading.presence
    if not isinstance(trend, Trend):
        return []
    what = trend.key.removeprefix("trend of ").partition("@")[0].replace("_", " ")
    return [
        f"something {trend.sentence} and acts like {what}; no law of the catalogue changes slowly, so that it has no "
        "name, and the simulator has what acts on average"
    ]


def untouched(naming: Naming, mismatches: Sequence[Mismatch], accounted: Sequence[Channel]) -> list[str]:
    """Return in which channels much is missing that neither a named effect nor a formula acts on.

    The gap that closes is of the other channels.
    """
    known = {channel.name for channel in accounted}
    much = [m for m in mismatches if m.channel.name not in known and m.share >= _NOTABLE_SHARE]
    if not (naming.named and much):
        return []
    places = " and ".join(f"{m.channel.name} ({m.share:.0%} of the error)" for m in much)
    return [
        f"nothing that is named acts on {places}: what is missing there is not known, and the share of the gap that "
        "closes leaves it out"
    ]


def _doubts(naming: Naming, problem: Problem, memories: Sequence[Memory], held_out: bool) -> list[str]:
    doubts = []
    if not held_out:
        why = (
            "there is only one run" if problem.presence is None else "no run with all effects was kept for it"
        )
        doubts.append(f"{why}: nothing could be held out, so the fit is judged on the data it was fitted to")
    for named in naming.named:
        if isinstance(named.effect, MeasurementEffect) or named.effect.key not in naming.best.keys:
            continue
        for drift in drifts_of(naming.fit, named.effect, problem.blocks, problem.cluster):
            if drift.notable:
                doubts.append(
                    f"{named.effect.name}: {drift.parameter} differs between runs by {drift.spread:.0%} of its "
                    "value; it may be absorbing another effect"
                )
    lasting = remembered(memories)
    if lasting:
        more = f" (the same in {len(lasting) - 1} other channels)" if len(lasting) > 1 else ""
        doubts.append(f"{lasting[0].sentence}{more}")
    return doubts
