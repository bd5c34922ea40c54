"""The stage that trains a learned dynamics model."""

import json
import logging
import math
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.models.settings import Training
from pipeline.stage import StageConfig, StageRun, stage

if TYPE_CHECKING:
    from pipeline.models.contract import DynamicsModel
    from pipeline.models.layout import Layout
    from pipeline.models.windows import Series
    from pipeline.recordings.recording import Recording

VALIDATION_SHARE = 0.2
CHECKPOINTS = "checkpoints"


@dataclass
class TrainStage(StageConfig):
    """What training reads of the configuration."""

    recording: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    model: dict[str, Any] = field(default_factory=dict)
    train: Training = field(default_factory=Training)


@stage(TrainStage)
def train(config: TrainStage, run: StageRun) -> None:
    """Train a learned dynamics model and score it on held-out runs against persistence."""
    if config.train.enabled:
        _train(config, run)
        return
    logging.getLogger("simgap").info("train: nothing is trained, since train.enabled is false")
    _write_metrics({}, run)


def _train(config: TrainStage, run: StageRun) -> None:
    """Fit a model to the recording, write it and score it."""
    from pipeline.models.contract import FitContext, Provenance
    from pipeline.models.layout import layout_of
    from pipeline.models.registry import model_class, model_settings
    from pipeline.recordings.recording import read_recording
    from pipeline.recordings.split import require_holdout

    path = run.input(config.recording or config.artifact("clean", "recording.parquet"))
    data = run.inputs[str(path)]
    settings = model_settings(config.model)
    recording = read_recording(path)
    layout = layout_of(recording, config.train.layout).on(config.platform)
    model = model_class(config.model)(layout, settings, recording.time_step)
    require_holdout(recording.split, str(path))
    fitted, chosen, held = _series(recording, layout, run)
    fitted = fitted.excerpt(config.train.share, config.train.shift)
    checkpoint = _checkpoint_folder(config, settings, data)
    loss = model.fit(fitted, chosen, config.train, FitContext(config.seed, checkpoint, run.log_metrics))
    model.provenance = Provenance(
        data=data,
        data_source=recording.source,
        chosen_by="validation loss: one-step mean squared error, scaled",
        value=loss,
        seed=config.seed,
        training=asdict(config.train),
    )
    model.save(run.output / "model")
    run.log_metrics({"best_validation_loss": loss})
    _score(model, held, config.train, run)
    _discard(checkpoint)


def _series(recording: "Recording", layout: "Layout", run: StageRun) -> "tuple[Series, Series, Series]":
    """Return the series to fit, to choose by and to score on."""
    from pipeline.models.windows import series_of
    from pipeline.recordings.split import runs_of

    fitted, chosen, held = (
        series_of(recording, layout, runs_of(recording.split, part))
        for part in ("train", "validation", "holdout")
    )
    if not len(chosen):
        run.warn(f"no validation run: the last {VALIDATION_SHARE:.0%} of each training segment validates")
        fitted, chosen = fitted.split_tail(VALIDATION_SHARE)
    return fitted, chosen, held


def _score(model: "DynamicsModel", held: "Series", settings: Training, run: StageRun) -> None:
    """Write the errors on held-out runs."""
    from pipeline.models.evaluation import rollout_errors
    from pipeline.models.free_run import free_run_scores
    from pipeline.models.residual_ratios import residual_ratios

    metrics: dict[str, Any] = dict(
        rollout_errors(model, held, settings.horizons, settings.evaluation_windows)
    )
    if settings.free_run:
        metrics["free_run"] = free_run_scores(model, held, settings.free_run)
    if settings.residual_ratios:
        metrics["residual_ratios"] = residual_ratios(model, held)
    _write_metrics(_finite(metrics), run)
    run.log_metrics(_flat(metrics))


def _write_metrics(metrics: dict[str, Any], run: StageRun) -> None:
    (run.output / "metrics.json").write_text(json.dumps(metrics, indent=2) + "\n")


def _discard(checkpoint: Path) -> None:
    """Remove the checkpoint of a training that is done."""
    import contextlib
    import shutil

    shutil.rmtree(checkpoint, ignore_errors=True)
    with contextlib.suppress(OSError):  # another training may have its checkpoint beside
        checkpoint.parent.rmdir()


def _checkpoint_folder(config: TrainStage, settings: Any, data: str) -> Path:
    """Return where an interrupted training with the same data and settings left its checkpoint."""
    from pipeline.artifacts import hash_value

    identity = hash_value([asdict(settings), asdict(config.train), config.seed, data])
    return Path(config.artifacts) / CHECKPOINTS / identity[:16]


def _finite(errors: Any) -> Any:
    """Return the errors with None, which JSON can say, where a rollout has run away."""
    if isinstance(errors, dict):
        return {key: _finite(value) for key, value in errors.items()}
    return errors if math.isfinite(errors) else None


def _flat(metrics: dict[str, Any]) -> dict[str, float]:
    """Return nested numbers by the path of their keys."""
    flat: dict[str, float] = {}
    for key, value in metrics.items():
        if isinstance(value, dict):
            flat |= {f"{key}/{name}": number for name, number in _flat(value).items()}
        else:
            flat[key] = value
    return flat


if __name__ == "__main__":
    train.main()
