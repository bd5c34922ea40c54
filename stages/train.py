"""The stage that trains a learned dynamics model."""

import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from simgap.artifacts import checkpoint_folder, remove_checkpoint
from simgap.comparison.comparison import Metrics, flat
from simgap.models.settings import Training
from simgap.platforms.settings import TRAINED, SimulatorSettings
from simgap.runner import StageConfig, StageRun, stage

if TYPE_CHECKING:
    from simgap.models.contract import DynamicsModel
    from simgap.models.layout import Layout
    from simgap.models.step_scores import NextValues
    from simgap.models.windows import Series
    from simgap.recordings.recording import Recording

VALIDATION_SHARE = 0.2
NAIVE = "/naive"  # ends the names of the errors of the assumption that nothing changes


@dataclass
class TrainStage(StageConfig):
    """The configuration of training."""

    recording: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    simulator: SimulatorSettings = field(default_factory=SimulatorSettings)
    model: dict[str, Any] = field(default_factory=dict)
    train: Training = field(default_factory=Training)


def compared(metrics: Mapping[str, Any]) -> dict[str, Metrics]:
    """Return the scores of a model, and those of persistence (nothing changes)."""
    scores = flat(metrics)
    naive = {name.removesuffix(NAIVE): value for name, value in scores.items() if name.endswith(NAIVE)}
    own = {name.removesuffix("/model"): value for name, value in scores.items() if not name.endswith(NAIVE)}
    return {"": own, "persistence": naive}


@stage(TrainStage, compared)
def train(config: TrainStage, run: StageRun) -> None:
    """Train a learned dynamics model and compare it with persistence on held-out runs."""
    if config.train.enabled:
        _train(config, run)
        return
    run.leave_out("train: nothing is trained, because train.enabled is false")


def _train(config: TrainStage, run: StageRun) -> None:
    """Fit a model to the recording, write it and score it."""
    from simgap.models.accelerator import accelerated
    from simgap.models.contract import FitContext, Provenance
    from simgap.models.layouts import layout_of
    from simgap.models.registry import model_class, model_settings
    from simgap.models.scores import held_out_scores, one_step_scores
    from simgap.models.step_scores import next_values
    from simgap.models.storage import save_model
    from simgap.recordings.recording import read_recording
    from simgap.recordings.split import require_holdout

    path = run.input(config.recording or config.artifact("clean", "recording.parquet"))
    data = run.inputs[str(path)]
    settings = model_settings(config.model)
    recording = _prepared(read_recording(path), config.train)
    layout = layout_of(recording, config.train.layout).on(config.platform)
    model = model_class(config.model)(layout, settings, recording.time_step)
    if config.simulator.residual == TRAINED:
        _leave_physics_out(model, recording, config, run)
    require_holdout(recording.split, str(path))
    fitted, chosen, held = _series(recording, layout, run)
    fitted = fitted.excerpt(config.train.share, config.train.shift)
    fitted, chosen, held = (
        series.with_noise(config.train.noise, config.seed + part)
        for part, series in enumerate((fitted, chosen, held))
    )
    checkpoint = checkpoint_folder(
        config.artifacts,
        [asdict(settings), asdict(config.train), asdict(config.simulator), config.seed, data],
    )
    loss = model.fit(fitted, chosen, config.train, FitContext(config.seed, checkpoint, run.log_metrics))
    model.provenance = Provenance(
        data=data,
        data_source=recording.source,
        chosen_by=f"validation loss over {config.train.steps} step(s), scaled",
        value=loss,
        seed=config.seed,
        training=asdict(config.train),
    )
    machines = _machines(recording, layout) | {"": held}
    history = config.train.evaluation_history
    before: dict[str, NextValues] = {}
    if config.train.bias_correction:
        with accelerated(model):
            before = next_values(model, machines, history)
            model.correct(chosen)
    save_model(model, run.output / "model")
    with accelerated(model):
        after = next_values(model, machines, history)
        scores = held_out_scores(model, held, config.train, FitContext(config.seed))
        _write_traces(model, held, config.train, run)
    _write_residuals(after, before, _units(recording, layout, after), run)
    scores |= one_step_scores(after, before) | {"validation": {"loss": loss}}
    _write_metrics(_finite(scores), run)
    run.log_metrics({name: value for name, value in flat(scores).items() if value is not None})
    remove_checkpoint(checkpoint)


def _leave_physics_out(
    model: "DynamicsModel", recording: "Recording", config: TrainStage, run: StageRun
) -> None:
    """Let a model learn what the nominal simulator leaves of the motion."""
    from simgap.models.simulated import physics_of
    from simgap.simulation.build import build_simulator

    identified = None
    if config.simulator.identified:
        identified = run.input(config.artifact("sysid", "parameters.yaml"))
    simulator = build_simulator(config.platform, config.simulator, recording.units, identified)
    model.explain_by(physics_of(simulator, model.layout, recording.time_step))


def _prepared(recording: "Recording", settings: Training) -> "Recording":
    """Return the recording filtered, where that is asked for."""
    from simgap.models.zero_phase import zero_phase

    return recording if settings.zero_phase is None else zero_phase(recording, settings.zero_phase)


def _series(recording: "Recording", layout: "Layout", run: StageRun) -> "tuple[Series, Series, Series]":
    """Return the series to fit, to choose by and to score on."""
    from simgap.models.windows import series_of
    from simgap.recordings.split import runs_of

    fitted, chosen, held = (
        series_of(recording, layout, runs_of(recording.split, part))
        for part in ("train", "validation", "holdout")
    )
    if not len(chosen):
        run.warn(f"no validation run: the last {VALIDATION_SHARE:.0%} of each training segment validates")
        fitted, chosen = fitted.split_tail(VALIDATION_SHARE)
    return fitted, chosen, held


def _machines(recording: "Recording", layout: "Layout") -> "dict[str, Series]":
    """Return the held-out series of each of a layout's machines."""
    from simgap.models.windows import series_of
    from simgap.recordings.split import runs_of

    runs = runs_of(recording.split, "holdout")
    return {name: series_of(recording, layout, runs, [name]) for name in layout.machines()}


def _units(recording: "Recording", layout: "Layout", outputs: Iterable[str]) -> dict[str, str]:
    """Return the units of the outputs; that of all machines together is that of the first."""
    first = next(iter(layout.machines()))
    return {name: recording.units.get(name, recording.units.get(f"{name}{first}", "")) for name in outputs}


def _write_traces(model: "DynamicsModel", held: "Series", settings: Training, run: StageRun) -> None:
    """Write the measured and modelled traces of a free run, and their figure, where one is asked for."""
    from simgap.models.free_run import free_run_traces
    from simgap.models.trace_figure import trace_figure

    if not settings.free_run:
        return
    traces = free_run_traces(model, held, settings.free_run)
    traces.to_parquet(run.output / "free_run.parquet", index=False)
    (run.output / "free_run.svg").write_text(trace_figure(traces), encoding="utf-8")


def _write_residuals(
    after: "dict[str, NextValues]", before: "dict[str, NextValues]", units: dict[str, str], run: StageRun
) -> None:
    """Draw how the one-step residuals are distributed, beside those before a correction."""
    from simgap.models.residual_figure import residual_figure

    residuals, uncorrected = (
        {name: values.residuals.numpy() for name, values in part.items()} for part in (after, before)
    )
    figure = residual_figure(residuals, uncorrected, units)
    (run.output / "residuals.svg").write_text(figure, encoding="utf-8")


def _write_metrics(metrics: dict[str, Any], run: StageRun) -> None:
    (run.output / "metrics.json").write_text(json.dumps(metrics, indent=2) + "\n")


def _finite(errors: Any) -> Any:
    """Return the errors with None, which JSON can say, where a rollout has run away."""
    if isinstance(errors, dict):
        return {key: _finite(value) for key, value in errors.items()}
    return errors if math.isfinite(errors) else None


if __name__ == "__main__":
    from simgap.runner.command import main

    main(train)
