"""From a cleaned recording and a nominal simulator to a diagnosis."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from simgap.effects import MeasurementEffect, ParameterError
from simgap.gap.candidate import BEYOND_NOISE, FEWEST_MORE
from simgap.gap.coarseness import coarse_axes, coarseness_of
from simgap.gap.command_hold import name_with_hold
from simgap.gap.contradiction import contradictions
from simgap.gap.drift import Drift, drifts_of
from simgap.gap.features import features_of
from simgap.gap.fit import Problem, channels_of, excess_of
from simgap.gap.horizon import HorizonError, horizon_errors
from simgap.gap.latent_inputs import name_with_latent_inputs
from simgap.gap.learned import LearnedResidual, learn, learned_rows
from simgap.gap.locate import Mismatch, locate
from simgap.gap.name import Naming
from simgap.gap.prepare import prepare
from simgap.gap.probability import Features, presence_of, probability_of
from simgap.gap.regimes import Regime, regimes_of
from simgap.gap.residuals import channels_on, noise_of_rows
from simgap.gap.rollout_fit import refit_through_rollouts
from simgap.gap.scoring import cross_validated, folds_of
from simgap.gap.settings import Gap
from simgap.gap.unnamed import Unnamed, find_unnamed
from simgap.gap.validate import Validation, validate
from simgap.gap.whiteness import Memory, memories_of, remembered
from simgap.platforms.mechanism import Channel
from simgap.recordings.contradiction import Contradiction
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks
from simgap.simulation.driver import with_drivers

_FEW_CLUSTERS = 10  # below which a warning says that the recording is short
_BELIEVED = 0.5  # presence from which an effect decides the verdict
_NOTABLE_SHARE = 0.1  # of the energy that was left before
_NEVER_FITTED = "no fitted run contains such motion; record more runs like them"
_LAW_FAILS = "an unknown effect, or a law that holds only approximately, is stronger there"


@dataclass(frozen=True)
class Diagnosis:
    """The result of `diagnose`.

    Attributes:
        verdict: `missing_physics`, `parameter_mismatch`, `none`, `unexplained` or `contradiction`.
        contradictions: of the recording with itself or the platform; nothing is named where there are any.
        warnings: doubts about recording and result.
        mismatches: where the nominal simulator fails.
        naming: the selection of effects and its result.
        features: features of each named effect's probability, by key.
        drifts: drift of each named effect's parameters between runs, by key.
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
    features: dict[str, Features]
    drifts: dict[str, list[Drift]]
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
        return {key: probability_of(features) for key, features in self.features.items()}

    @property
    def channels(self) -> tuple[Channel, ...]:
        """The equations that the recording was held against."""
        return channels_on(self.nominal, self.fitting.blocks)


def diagnose(recording: Recording, nominal: Simulator, settings: Gap) -> Diagnosis:
    """Locate the mismatch between a recording and a simulator, name the missing effects, fit and validate them.

    Args:
        recording: cleaned, with its runs divided into train, validation and hold-out.
        nominal: what is believed before.
        settings: of the gap engine.

    Raises:
        InputError: when the recording is too short or of another kind than the platform, or a setting out of its range.
    """
    settings.check()
    prepared = prepare(recording, nominal, settings)
    contradicted = contradictions(recording, prepared)
    if contradicted:
        settings = replace(settings, effects=[])
    read = name_with_hold(prepared, recording, nominal, settings)
    prepared, naming = name_with_latent_inputs(*read, settings)
    nominal, problem, proving = prepared.nominal, prepared.problem, prepared.proving
    fitted, functions, cluster, held_out = (
        problem.blocks,
        problem.functions,
        problem.cluster,
        prepared.held_out,
    )
    refitted, _ = refit_through_rollouts(naming.fit, problem, settings.fit_horizon, settings.folds)
    naming, simulator = replace(naming, fit=refitted), refitted.simulator
    problem = replace(problem, noise=noise_of_rows(simulator, fitted, functions))
    channels, regimes = channels_on(nominal, fitted), regimes_on(fitted, simulator)
    mismatches = locate(naming.base.residual, channels, regimes, problem)
    fold = folds_of(fitted, settings.folds)
    residual = cross_validated(naming.fit, fold)
    unnamed = find_unnamed(
        residual, naming.base.residual, channels, regimes, problem, fold, settings.least_share
    )
    drifts = {c.effect.key: drifts_of(naming.fit, c.effect, fitted, cluster) for c in naming.named}
    weights = {rivalry.winner.key: rivalry.weight for rivalry in naming.rivalries}
    coarse = coarse_axes(naming.fit, problem, channels) if naming.named else {}
    features = {
        c.effect.key: replace(
            features_of(c, naming.fit, problem, drifts[c.effect.key], weights.get(c.effect.key, 1.0)),
            coarse=channels[c.channel].name in coarse,
        )
        for c in naming.named
    }
    counted = _counted(naming, mismatches, channels)
    memories = memories_of(residual, channels, problem)
    learned = learn(residual, channels, regimes, problem, fold)
    beside = learned_rows(learned, channels, regimes_on(proving, simulator), functions)
    validation = validate(
        nominal, simulator, proving, functions, counted, held_out, settings.resamples, beside
    )
    if validation.refutes:
        features = {key: replace(each, refuted=True) for key, each in features.items()}
    unseen = _held_out_only(validation, naming, problem, channels)
    gap = bool(unnamed or unseen) or any(m.excess > BEYOND_NOISE for m in mismatches)
    doubts = (
        *_disproved(naming, validation),
        *_shortness(problem),
        *coarseness_of(coarse, fitted.time_step),
        *_doubts(naming, drifts, () if contradicted else memories, held_out),
        *unseen,
    )
    return Diagnosis(
        verdict="contradiction"
        if contradicted
        else _verdict(naming, features, gap, _remains(naming, problem, validation)),
        contradictions=tuple(contradicted),
        warnings=tuple(
            dict.fromkeys(
                (*(c.sentence for c in contradicted), *recording.warnings, *prepared.remarks, *doubts)
            )
        ),
        mismatches=mismatches,
        naming=naming,
        features=features,
        drifts=drifts,
        unnamed=[] if contradicted else unnamed,
        learned=learned,
        memories=memories,
        validation=validation,
        horizons=horizon_errors(nominal, simulator, proving, settings.horizon, settings.resamples),
        fitting=problem,
        proving=proving,
        nominal=nominal,
        simulator=with_drivers(simulator, fitted.signals),
    )


def regimes_on(blocks: Blocks, simulator: Simulator) -> list[Regime]:
    """Return the regime variables on the blocks without their margins."""
    signals = simulator.along_time(blocks.signals, blocks.time_step)
    inner = {name: blocks.inner(series) for name, series in signals.items()}
    return regimes_of(simulator.platform.kind, inner, simulator.position_unit)


def _counted(naming: Naming, mismatches: Sequence[Mismatch], channels: Sequence[Channel]) -> list[Channel]:
    """Return the channels that enter the metric: those that the named effects act on, else where it fails."""
    touched = {index for candidate in naming.named for index in channels_of(naming.fit, candidate.effect)}
    counted = [channels[index] for index in sorted(touched)] or list(channels)
    failing = {mismatch.channel.name for mismatch in mismatches}
    return [channel for channel in counted if channel.name in failing] or counted


def _verdict(naming: Naming, features: Mapping[str, Features], gap: bool, remains: bool) -> str:
    """Return the verdict; a gap that no believed effect explains is `unexplained`.

    Args:
        naming: the named effects.
        features: features of each, by key.
        gap: whether there is a gap.
        remains: whether much of it remains beside the named effects.
    """
    if not naming.named:
        return "unexplained" if gap else "none"
    physics = [c.effect.key for c in naming.named if not isinstance(c.effect, ParameterError)]
    if not remains:
        return "missing_physics" if physics else "parameter_mismatch"
    believed = any(presence_of(features[key]) >= _BELIEVED for key in physics)
    return "missing_physics" if believed else "unexplained"


def _remains(naming: Naming, problem: Problem, validation: Validation) -> bool:
    """Whether some channel still leaves much, or the held-out runs are predicted worse."""
    before, after = (excess_of(each, problem.noise) for each in (naming.base, naming.fit))
    much = (after > BEYOND_NOISE) & (after > _NOTABLE_SHARE * before)
    return bool(much.any()) or bool(_disproved(naming, validation))


def _held_out_only(
    validation: Validation, naming: Naming, problem: Problem, channels: Sequence[Channel]
) -> list[str]:
    """Return a warning for each channel in which held-out runs show what no fitted run does."""
    _, after, noise = validation.channels.square().unbind(1)
    fitted = excess_of(naming.fit, problem.noise).clamp_min(1.0)
    return [
        f"{channel.name}: the error energy is {proved:.2g} times the noise on held-out runs and {known:.2g} times on "
        f"fitted runs; {_LAW_FAILS if known > BEYOND_NOISE else _NEVER_FITTED}"
        for channel, proved, known in zip(channels, (after / noise).tolist(), fitted.tolist(), strict=True)
        if proved > BEYOND_NOISE * known
    ]


def _disproved(naming: Naming, validation: Validation) -> list[str]:
    """Return a warning if the held-out runs contradict the named effects."""
    if not (naming.named and validation.disproves):
        return []
    return [
        "the named effects make the prediction of the held-out runs worse: do not rely on them; record more runs that "
        "resemble each other"
    ]


def _shortness(problem: Problem) -> list[str]:
    """Return a sentence about a recording that is too short for many names."""
    clusters = int(problem.cluster.max()) + 1
    if clusters >= _FEW_CLUSTERS:
        return []
    seconds = len(problem.blocks) * problem.blocks.samples * problem.blocks.time_step
    most = max(clusters - FEWEST_MORE, 0)
    return [
        f"only {seconds:.2g} s could be fitted, enough for {most} parameters at most; record at least ten seconds"
    ]


def _doubts(
    naming: Naming, drifts: dict[str, list[Drift]], memories: Sequence[Memory], held_out: bool
) -> list[str]:
    doubts = []
    if not held_out:
        doubts.append(
            "there is only one run: nothing could be held out, so the fit is judged on the data it was fitted to"
        )
    for candidate in naming.named:
        for drift in drifts[candidate.effect.key]:
            if drift.notable and not isinstance(candidate.effect, MeasurementEffect):
                doubts.append(
                    f"{candidate.effect.name}: {drift.parameter} differs between runs by {drift.spread:.0%} of its "
                    "value; it may be absorbing another effect"
                )
    lasting = remembered(memories)
    if lasting:
        more = f" (the same in {len(lasting) - 1} other channels)" if len(lasting) > 1 else ""
        doubts.append(f"{lasting[0].sentence}{more}")
    return doubts
