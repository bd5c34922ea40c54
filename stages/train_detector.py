"""The stage that trains a gate detector on images that it draws."""

from dataclasses import asdict, dataclass, field

from simgap.perception.settings import PerceptionSettings
from simgap.runner import StageConfig, StageRun, in_pipeline, stage


@dataclass
class TrainDetectorStage(StageConfig):
    """The configuration of a detector's training."""

    perception: PerceptionSettings = field(default_factory=PerceptionSettings)


@stage(TrainDetectorStage)
def train_detector(config: TrainDetectorStage, run: StageRun) -> None:
    """Train a gate detector on rendered images, and write it with its ONNX export."""
    settings, learning = config.perception, config.perception.detector.learning
    if in_pipeline() and not settings.detector.enabled:
        run.leave_out("train_detector: no detector is trained, because perception.detector.enabled is false")
        return

    import torch

    from simgap.artifacts import checkpoint_folder, remove_checkpoint
    from simgap.models.contract import FitContext
    from simgap.models.settings import Training
    from simgap.models.training import train_module
    from simgap.perception.detector import Detector
    from simgap.perception.learning import Learning
    from simgap.perception.storage import export_detector, save_detector

    network = Detector(settings.detector)
    module = Learning(network, settings, config.seed)
    checkpoint = checkpoint_folder(config.artifacts, [asdict(settings), config.seed])
    training = Training(max_epochs=learning.epochs, patience=learning.epochs)
    loss = train_module(module, network, training, FitContext(config.seed, checkpoint, run.log_metrics))
    images = learning.epochs * learning.steps * learning.batch
    device = torch.cuda.get_device_name() if torch.cuda.is_available() else "CPU"
    trained = {"seed": config.seed, "images": images, "validation_loss": loss, "device": device}
    folder = run.output / "detector"
    save_detector(network, settings, trained, folder)
    export_detector(network, module.camera.size, folder)
    run.log_metrics({"validation_loss": loss})
    run.say(f"validation loss {loss:.4g} after at most {images} images")
    remove_checkpoint(checkpoint)


if __name__ == "__main__":
    from simgap.runner.command import main

    main(train_detector)
