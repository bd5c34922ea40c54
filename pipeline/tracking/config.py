"""Where runs are logged."""

from dataclasses import dataclass


@dataclass
class Tracking:
    """The settings of the experiment tracker.

    Attributes:
        enabled: whether runs are logged at all.
        uri: of the MLflow store; null means `mlflow.db` in the project's folder.
    """

    enabled: bool = True
    uri: str | None = None
