"""From a cleaned recording and a nominal simulator to a diagnosis."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pipeline.effects import MeasurementEffect, ParameterError
from pipeline.effects.delay import CommandDelay
from pipeline.gap.competition import BEYOND_NOISE
from pipeline.gap.fit import Fit, Problem, channels_of, excess_of, fit
from pipeline.gap.horizon import HorizonError, horizon_errors
from pipeline.gap.locate import Mismatch, locate
from pipeline.gap.model import Drift, drifts_of, unsteadiness_of
from pipeline.gap.name import Naming, name
from pipeline.gap.preparation import Prepared, prepare
from pipeline.gap.probability import Signs, probability_of
from pipeline.gap.prove import Proof, prove
from pipeline.gap.regimes import Regime, regimes_of
from pipeline.gap.residuals import channels_on, noise_of_rows
from pipeline.gap.rollout_fit import refit_through_rollouts
from pipeline.gap.scoring import cross_validated, folds_of
from pipeline.gap.settings import Gap
from pipeline.gap.timing import HELD_KINDS
from pipeline.gap.unnamed import Unnamed, find_unnamed
from pipeline.platforms.mechanism import Channel
from pipeline.recordings.recording import Recording
from pipeline.simulation import Simulator
from pipeline.simulation.blocks import Blocks

_NEARLY = 0.3  # of half a sample


@dataclass(frozen=True)
class Diagnosis:
    """What `diagnose` found.

    Attributes:
        verdict: `missing_physics`, `parameter_mismatch`, `none` or `unexplained`.
        warnings: doubts about recording and result.
        mismatches: where the nominal simulator fails.
        naming: the competition and its result.
        signs: what speaks for each named effect and against it, by key.
        drifts: of each named effect's parameters between runs, by key.
        unnamed: what no effect of the catalogue accounts for.
        proof: errors before and after on held-out runs.
        horizons: errors of open-loop predictions.
        fitting: the problem that was fitted.
        proving: the blocks that it was proved on.
        nominal: the simulator before.
        simulator: the simulator after.
        through_rollouts: whether its values come from multi-step predictions, else from the equations of motion.
    """

    verdict: str
    warnings: tuple[str, ...]
    mismatches: list[Mismatch]
    naming: Naming
    signs: dict[str, Signs]
    drifts: dict[str, list[Drift]]
    unnamed: list[Unnamed]
    proof: Proof
    horizons: list[HorizonError]
    fitting: Problem
    proving: Blocks
    nominal: Simulator
    simulator: Simulator
    through_rollouts: bool

    @property
    def probabilities(self) -> dict[str, float]:
        """The probability of each named effect, by key."""
        return {key: probability_of(signs) for key, signs in self.signs.items()}

    @property
    def channels(self) -> tuple[Channel, ...]:
        """The equations that the recording was held against."""
        return channels_on(self.nominal, self.fitting.blocks)


def diagnose(recording: Recording, nominal: Simulator, settings: Gap) -> Diagnosis:
    """Locate the mismatch between a recording and a simulator, name it, model it and prove it.

    Args:
        recording: cleaned, with its runs divided into train, validation and hold-out.
        nominal: what is believed before.
        settings: of the gap engine.

    Raises:
        InputError: when the recording is too short or of another kind than the platform.
    """
    prepared, naming = _named(recording, nominal, settings)
    nominal, problem, proving = prepared.nominal, prepared.problem, prepared.proving
    fitted, functions, cluster, held_out = (
        problem.blocks,
        problem.functions,
        problem.cluster,
        prepared.held_out,
    )
    refitted, through_rollouts = refit_through_rollouts(
        naming.fit, problem, settings.fit_horizon, settings.folds
    )
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
    counted = _counted(naming, mismatches, channels)
    proof = prove(nominal, simulator, proving, functions, counted, held_out, settings.resamples)
    return Diagnosis(
        verdict=_verdict(naming, bool(unnamed) or any(m.excess > BEYOND_NOISE for m in mismatches)),
        warnings=(*recording.warnings, *prepared.remarks, *_doubts(naming, drifts, held_out)),
        mismatches=mismatches,
        naming=naming,
        signs=_signs(naming, drifts, problem, unnamed, channels),
        drifts=drifts,
        unnamed=unnamed,
        proof=proof,
        horizons=horizon_errors(nominal, simulator, proving, settings.horizon, settings.resamples),
        fitting=problem,
        proving=proving,
        nominal=nominal,
        simulator=simulator,
        through_rollouts=through_rollouts,
    )


def _named(recording: Recording, nominal: Simulator, settings: Gap) -> tuple[Prepared, Naming]:
    """Name what is missing, with the commands where they act.

    Which of the two readings of a command is right, held or measured, may not show before the physics is known. The
    other one is tried where what was named leaves less of it, where several names may have made up for a wrong one, and
    where a delay or an offset of half a sample was needed, which is no physics.
    """
    prepared = prepare(recording, nominal, settings)
    naming = name(prepared.nominal, prepared.problem, settings)
    if recording.kind not in HELD_KINDS:
        return prepared, naming
    late = _is_late_by_half_a_sample(naming, prepared)
    other = prepare(recording, nominal, settings, held=not prepared.problem.blocks.held)
    if (
        not late
        and len(naming.named) < 2
        and _left(_refitted(naming, other), other) >= _left(naming.fit, prepared)
    ):
        return prepared, naming
    renamed = name(other.nominal, other.problem, settings)
    if late:
        return (prepared, naming) if _is_late_by_half_a_sample(renamed, other) else (other, renamed)
    return min((prepared, naming), (other, renamed), key=lambda reading: _cost(*reading))


def _refitted(naming: Naming, prepared: Prepared) -> Fit:
    """Fit the effects that were named to commands that are read the other way."""
    return fit(prepared.nominal.with_effects(naming.fit.simulator.effects), prepared.problem)


def _left(fitted: Fit, prepared: Prepared) -> float:
    """Return the logarithm of what a fit leaves over the noise, summed over channels."""
    return float(excess_of(fitted, prepared.problem.noise).clamp_min(1.0).log().sum())


def _cost(prepared: Prepared, naming: Naming) -> float:
    """Return what is left, and one for each name that it takes: a name is worth a factor of e."""
    return _left(naming.fit, prepared) + len(naming.named)


def _is_late_by_half_a_sample(naming: Naming, prepared: Prepared) -> bool:
    half = 0.5 * prepared.problem.blocks.time_step
    late = -half if prepared.problem.blocks.held else half
    shifts = [
        fitted.values[parameter.name]
        for fitted in naming.fit.simulator.free
        for parameter in fitted.effect.parameters
        if isinstance(fitted.effect, MeasurementEffect | CommandDelay) and parameter.unit == "s"
    ]
    return any(abs(shift - late) < _NEARLY * half for shift in shifts)


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


def _verdict(naming: Naming, gap: bool) -> str:
    """Say it in a word; a gap without any name for it, whether a formula was found or not, is unexplained."""
    if any(not isinstance(candidate.effect, ParameterError) for candidate in naming.named):
        return "missing_physics"
    if naming.named:
        return "parameter_mismatch"
    return "unexplained" if gap else "none"


def _signs(
    naming: Naming,
    drifts: dict[str, list[Drift]],
    problem: Problem,
    unnamed: Sequence[Unnamed],
    channels: Sequence[Channel],
) -> dict[str, Signs]:
    """Return what speaks for each named effect and against it.

    What remains without a name in an effect's own channels may be what the effect stands in for.
    """
    weight = {rivalry.winner.key: rivalry.weight for rivalry in naming.rivalries}
    left = {remainder.channel.name: remainder.share for remainder in unnamed}
    signs = {}
    for c in naming.named:
        own = [channels[i].name for i in channels_of(naming.fit, c.effect)]
        signs[c.effect.key] = Signs(
            gain=c.gain,
            parameters=len(c.effect.parameters),
            clusters=int(problem.cluster.max()) + 1,
            unsteadiness=unsteadiness_of(drifts[c.effect.key]),
            captured=c.share,
            signal=c.signal,
            excess=float(excess_of(naming.fit, problem.noise)[c.channel]),
            is_number=isinstance(c.effect, ParameterError),
            remainder=max((left.get(channel, 0.0) for channel in own), default=0.0),
            weight=weight.get(c.effect.key, 1.0),
        )
    return signs


def _doubts(naming: Naming, drifts: dict[str, list[Drift]], held_out: bool) -> list[str]:
    doubts = []
    if not held_out:
        doubts.append(
            "one run only: nothing could be held out, so the fit is judged on the data it was made on"
        )
    for candidate in naming.named:
        for drift in drifts[candidate.effect.key]:
            if drift.notable and not isinstance(candidate.effect, MeasurementEffect):
                doubts.append(
                    f"{candidate.effect.name}: {drift.parameter} differs between runs by {drift.spread:.0%} of its "
                    "value; it may be absorbing something else"
                )
    return doubts
