"""A sweep over configurations of one stage: `-m key=a,b,c`, serial or parallel by Hydra's launcher."""

import logging
import re
import shlex
import sys
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from simgap.artifacts import hash_value
from simgap.errors import InputError
from simgap.extras import require
from simgap.runner.comparing import Done, Failed, write_comparison
from simgap.runner.compose import ROOT_CONFIG, open_hydra, plain, prepare_overrides, typed
from simgap.runner.mistakes import configuration_mistakes
from simgap.runner.place import Place
from simgap.runner.threads import one_thread

if TYPE_CHECKING:
    from hydra.core.override_parser.types import Override
    from omegaconf import DictConfig

    from simgap.runner.wrapper import Stage

_LONGEST_NAME = 120
_log = logging.getLogger("simgap")
_ASIDE = ("hydra/launcher", "hydra.launcher.", "results")


@dataclass
class Task:
    """The work of one job, in this process or in a worker.

    Attributes:
        stage: what is run.
        sweep: identifies the sweep to which all its jobs belong.
        swept: the keys that differ between the jobs.
        naming: the keys by which jobs are called: those, and what a preset would sweep over where one value of it was
            asked for, so that a sweep run part by part puts every job where the whole would.
    """

    stage: "Stage[Any]"
    sweep: str
    swept: frozenset[str]
    naming: frozenset[str]

    def __call__(self, root: "DictConfig") -> Done | Failed:
        """Run the stage; a person's mistake is returned, since Hydra prints lines of its own on an exception."""
        one_thread()
        place = self._place()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                values = plain(root)
                config = typed(self.stage.config_class, values)
                done = self.stage.completed(values, place)
                target = done or self.stage.run(values, place)
        except InputError as error:
            return Failed(f"{place.job}: {error}")
        _log.info("%s: %s %s", self.stage.name, "kept" if done else "wrote", target)
        return Done(place, config, target)

    def _place(self) -> Place:
        from hydra.core.hydra_config import HydraConfig

        hydra = HydraConfig.get()
        own = [text for text in hydra.overrides.task if _key(text) in self.naming]
        differing = [text for text in own if _key(text) in self.swept]
        values = {_key(str(entry.input_line)): _value(entry) for entry in _parsed(differing)}
        preset = hydra.runtime.choices.get("experiment")
        return Place(self.sweep, job_name([preset or self.stage.name]), job_name(own), values)


def run_sweep(stage: "Stage[Any]", overrides: Sequence[str], config_dir: str | None = None) -> None:
    """Run one job per combination of the swept values, and compare the results.

    Raises:
        InputError: when jobs could not be run, after all the others have; every one is named.
    """
    from hydra.types import RunMode

    require("matplotlib")  # of the comparison, which is drawn when all jobs are done
    prepared = prepare_overrides(overrides, config_dir)
    with configuration_mistakes():
        hydra = open_hydra(config_dir)
        root = hydra.compose_config(ROOT_CONFIG, prepared, RunMode.MULTIRUN, with_log_configuration=False)
        preset = [f"{key}={value}" for key, value in (root.hydra.sweeper.get("params") or {}).items()]
        prepared = _as_in_preset(prepared, preset)
        swept = _swept([*preset, *prepared])
        task = Task(stage, _identity(stage, prepared), swept, swept | _swept(preset))
        batches = open_hydra(config_dir).multirun(ROOT_CONFIG, task, prepared, with_log_configuration=True)
    outcomes = [done.return_value for batch in batches for done in batch]
    write_comparison(stage, outcomes, f"simgap {stage.name} -m {shlex.join(overrides)}")
    mistakes = [outcome.mistake for outcome in outcomes if isinstance(outcome, Failed)]
    for mistake in mistakes[:-1]:
        print(f"simgap {stage.name}: {mistake}", file=sys.stderr)
    if mistakes:
        raise InputError(mistakes[-1])


def job_name(overrides: Sequence[str]) -> str:
    """Return a directory name for the job with these overrides."""
    name = re.sub(r"[^\w.,=+-]", "_", ",".join(text.lstrip("+") for text in overrides)) or "job"
    return name if len(name) <= _LONGEST_NAME else f"{name[:_LONGEST_NAME]}-{hash_value(list(overrides))[:8]}"


def _as_in_preset(overrides: Sequence[str], preset: Sequence[str]) -> list[str]:
    """Write swept keys as the preset does: Hydra takes `++key` and `key` for different keys."""
    written = {_key(text): text.partition("=")[0] for text in preset}
    return [
        f"{written[_key(text)]}={text.partition('=')[2]}" if _key(text) in written else text
        for text in overrides
    ]


def _swept(overrides: Sequence[str]) -> frozenset[str]:
    """Return the keys that differ between the jobs; a later value of a key replaces the earlier one."""
    sweeping = {_key(str(entry.input_line)): entry.is_sweep_override() for entry in _parsed(overrides)}
    return frozenset(key for key, sweeps in sweeping.items() if sweeps)


def _identity(stage: "Stage[Any]", overrides: Sequence[str]) -> str:
    """Return the identity of a sweep, independent of launcher and layout of results."""
    return hash_value([stage.name, *(text for text in overrides if not _key(text).startswith(_ASIDE))])


def _parsed(overrides: Sequence[str]) -> "list[Override]":
    from hydra.core.override_parser.overrides_parser import OverridesParser

    return OverridesParser.create().parse_overrides(list(overrides))


def _value(entry: "Override") -> Any:
    """Return a swept value as a number or text."""
    value = entry.value()
    return value if isinstance(value, int | float | str | None) else entry.get_value_element_as_str()


def _key(override: str) -> str:
    return override.partition("=")[0].lstrip("+")
