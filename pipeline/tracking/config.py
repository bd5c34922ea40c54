"""Where runs are logged."""

from dataclasses import dataclass

from simgap.artifacts.project import CHECKOUT
from simgap.extras import require


@dataclass
class Tracking:
    """The settings of the experiment tracker.

    Attributes:
        enabled: whether runs are logged; null: in a checkout of the repository, or where a `uri` is given.
        uri: of the MLflow store; null: `mlflow.db` in the checkout, elsewhere in the working directory.
    """

    enabled: bool | None = None
    uri: str | None = None

    @property
    def on(self) -> bool:
        """Whether runs are logged."""
        return self._asked_for or (self.enabled is None and CHECKOUT is not None)

    def check(self) -> None:
        """Refuse to go on where runs are to be logged and cannot be.

        Raises:
            InputError: when a person asked for tracking and MLflow is not installed.
        """
        if self._asked_for:
            require("mlflow")

    @property
    def _asked_for(self) -> bool:
        return self.enabled if self.enabled is not None else self.uri is not None
