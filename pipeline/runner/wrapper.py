"""The decorator that makes a function a stage: configuration, seed, tracking and atomic output around its call."""

import importlib
import inspect
import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, Generic, TypeVar

from simgap.artifacts import hash_value, staged_directory
from simgap.comparison.comparison import Compared, flat, itself
from simgap.extras import named_extras
from simgap.runner.completion import Note
from simgap.runner.compose import typed
from simgap.runner.config import StageConfig
from simgap.runner.place import Place
from simgap.runner.run import StageRun, read_metrics
from simgap.runner.seed import seed_everything
from simgap.tracking import KeptTracker, Tracker

Config = TypeVar("Config", bound=StageConfig)

# Where something is written or logged, and how it is compared, does not change what comes out.
_PLACES = ("output", "tracking", "results")


class Stage(Generic[Config]):
    """A function with a typed configuration that can be run from the command line.

    Calling it calls the plain function; `run` does what surrounds a call; `simgap.runner.command` is the command line.
    """

    def __init__(
        self,
        function: Callable[[Config, StageRun], None],
        config_class: type[Config],
        compared: Compared = itself,
    ) -> None:
        """Take the function's name and documentation."""
        self.function = function
        self.config_class = config_class
        self.compared = compared
        self.name = function.__name__
        self.__doc__ = inspect.getdoc(function)
        self.__module__ = function.__module__

    def __call__(self, config: Config, run: StageRun) -> None:
        """Do the work of the stage."""
        self.function(config, run)

    def run(self, values: dict[str, Any], place: Place | None = None) -> Path:
        """Run the stage with a composed configuration and return the directory it wrote.

        Args:
            values: the composed configuration of all stages.
            place: of a job in its sweep; its output gets a note of what it came from.

        Raises:
            InputError: on anything a person can mend.
        """
        config = typed(self.config_class, values)
        target = self._target(config, place)
        config.tracking.check()
        seed_everything(config.seed)
        tracker = self._tracker(Tracker, config, values, place)
        started = time.monotonic()
        succeeded = killed = False
        try:
            with named_extras(), staged_directory(target, owned=config.output is None) as output:
                run = StageRun(output, tracker)
                self.function(config, run)
                run.write_metrics()
                if place is not None:
                    seconds = time.monotonic() - started
                    Note(_identity(config), place.values, config.seed, seconds, run.inputs).write(output)
            succeeded = True
        except (KeyboardInterrupt, SystemExit):
            killed = True
            raise
        finally:
            tracker.finish(succeeded, killed)
        return target

    def completed(self, values: dict[str, Any], place: Place) -> Path | None:
        """Return the directory of a job that is done already, with the same configuration, inputs and code.

        Args:
            values: the composed configuration of all stages.
            place: of the job in its sweep.
        """
        config = typed(self.config_class, values)
        target = self._target(config, place)
        note = Note.read(target)
        if note is None or not note.holds(_identity(config)):
            return None
        tracker = self._tracker(KeptTracker, config, values, place)
        tracker.log_metrics(
            {key: value for key, value in flat(read_metrics(target)).items() if value is not None}
        )
        tracker.finish(True)
        return target

    def _target(self, config: Config, place: Place | None) -> Path:
        if place is None:
            return Path(config.output) if config.output else config.artifact(self.name, "")
        return (Path(config.output) if config.output else config.artifact("sweeps", place.folder)) / place.job

    def _tracker(
        self, tracker: type[Tracker], config: Config, values: dict[str, Any], place: Place | None
    ) -> Tracker:
        parameters = _without_places(asdict(config))
        if place is None:
            key = hash_value(_without_places(values))
            own = values.get("recording")
            title = Path(own).stem if own else config.name
            return tracker(config.tracking, self.name, title, key, parameters=parameters)
        title = f"{config.name}: sweep of {place.folder}"
        return tracker(config.tracking, self.name, title, place.sweep, place.job, parameters)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[str, str]]:
        """Travel to the workers of a sweep by name: there it stands for the stage, not for the function."""
        return import_stage, (self.__module__, self.name)


def stage(
    config_class: type[Config], compared: Compared = itself
) -> Callable[[Callable[[Config, StageRun], None]], Stage[Config]]:
    """Make a function of a configuration and a `StageRun` a stage of the function's name.

    Args:
        config_class: what it reads of the configuration.
        compared: what of its metrics stands in the comparison of a sweep's jobs.
    """
    return lambda function: Stage(function, config_class, compared)


def import_stage(module: str, name: str) -> Stage[Any]:
    """Return the stage of this name out of its module."""
    return getattr(importlib.import_module(module), name)


def _without_places(values: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in values.items() if key not in _PLACES}


def _identity(config: StageConfig) -> str:
    return hash_value(_without_places(asdict(config)))
