"""The decorator that makes a function a stage, and what happens around its call."""

import importlib
import sys
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, Generic, NoReturn, TypeVar

from pipeline.artifacts import hash_value, staged_directory
from pipeline.stage.compose import typed
from pipeline.stage.config import StageConfig
from pipeline.stage.run import StageRun
from pipeline.stage.seed import seed_everything
from pipeline.tracking import Tracker

Config = TypeVar("Config", bound=StageConfig)

# Where something is written or logged does not change what comes out.
_PLACES = ("output", "tracking")


class Stage(Generic[Config]):
    """A function with a typed configuration that can be run from the command line.

    Calling it calls the plain function; `main` is the command line.
    """

    def __init__(self, function: Callable[[Config, StageRun], None], config_class: type[Config]) -> None:
        """Take the function's name and documentation."""
        self.function = function
        self.config_class = config_class
        self.name = function.__name__
        self.__doc__ = function.__doc__
        self.__module__ = function.__module__

    def __call__(self, config: Config, run: StageRun) -> None:
        """Do the work of the stage."""
        self.function(config, run)

    def main(self, argv: list[str] | None = None) -> NoReturn:
        """Run the stage as a command with these arguments, by default those of the process, and exit."""
        from pipeline.stage.command import run_command

        arguments = sys.argv[1:] if argv is None else argv
        sys.exit(run_command(self._importable(), arguments))

    def run(self, values: dict[str, Any], job: str | None = None, sweep: str | None = None) -> Path:
        """Run the stage with a composed configuration and return the directory it wrote.

        Args:
            values: the composed configuration of all stages.
            job: what a job of a sweep is called among the others; also the name of its directory.
            sweep: what identifies the sweep.

        Raises:
            InputError: on anything a person can mend.
        """
        config = typed(self.config_class, values)
        target = self._target(config, job)
        seed_everything(config.seed)
        tracker = self._tracker(config, values, job, sweep)
        succeeded = False
        try:
            with staged_directory(target, owned=config.output is None) as output:
                run = StageRun(output, tracker)
                self.function(config, run)
                run.write_metrics()
            succeeded = True
        finally:
            tracker.finish(succeeded)
        return target

    def _target(self, config: Config, job: str | None) -> Path:
        if job is None:
            return Path(config.output) if config.output else config.artifact(self.name, "")
        return (Path(config.output) if config.output else config.artifact("sweeps", self.name)) / job

    def _tracker(self, config: Config, values: dict[str, Any], job: str | None, sweep: str | None) -> Tracker:
        identity = {key: value for key, value in values.items() if key not in _PLACES}
        parameters = {key: value for key, value in asdict(config).items() if key not in _PLACES}
        name = config.name if sweep is None else f"{config.name}: sweep of {self.name}"
        return Tracker(config.tracking, self.name, name, sweep or hash_value(identity), job, parameters)

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[str, str]]:
        """Travel to the workers of a sweep by name: there it stands for the stage, not for the function."""
        return _import, (self.__module__, self.name)

    def _importable(self) -> "Stage[Any]":
        """Return the same stage out of its module, which `python -m stages.NAME` calls `__main__`."""
        specification = getattr(sys.modules["__main__"], "__spec__", None)
        if self.__module__ != "__main__" or specification is None:
            return self
        return _import(specification.name, self.name)


def stage(config_class: type[Config]) -> Callable[[Callable[[Config, StageRun], None]], Stage[Config]]:
    """Make a function of a configuration and a `StageRun` a stage of the function's name."""
    return lambda function: Stage(function, config_class)


def _import(module: str, name: str) -> Stage[Any]:
    return getattr(importlib.import_module(module), name)
