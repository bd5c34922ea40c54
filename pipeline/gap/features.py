"""The features from which the probability of a named effect is computed."""

from collections.abc import Sequence

from simgap.effects import ParameterError
from simgap.gap.candidate import Candidate
from simgap.gap.drift import Drift, unsteadiness_of
from simgap.gap.fit import Fit, Problem, excess_of
from simgap.gap.probability import Features


def features_of(
    candidate: Candidate, fit: Fit, problem: Problem, drifts: Sequence[Drift], weight: float = 1.0
) -> Features:
    """Return the features of a named effect.

    Args:
        candidate: the effect, judged as if it had been the last to enter.
        fit: of the simulator with every named effect.
        problem: blocks, noise and clusters.
        drifts: of the effect's parameters between runs.
        weight: of the effect among those that the recording cannot tell from it.
    """
    return Features(
        gain=candidate.gain,
        parameters=len(candidate.effect.parameters),
        clusters=int(problem.cluster.max()) + 1,
        unsteadiness=unsteadiness_of(drifts),
        signal=candidate.signal,
        excess=float(excess_of(fit, problem.noise)[candidate.channel]),
        is_number=isinstance(candidate.effect, ParameterError),
        kind=fit.simulator.platform.kind,
        weight=weight,
    )
