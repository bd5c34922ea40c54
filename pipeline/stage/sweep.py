"""One stage, many configurations: `-m key=a,b,c`, serially or in parallel by Hydra's launcher."""

import logging
import re
import sys
import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pipeline.artifacts import hash_value
from pipeline.errors import InputError
from pipeline.stage.compose import ROOT_CONFIG, open_hydra, plain, prepare_overrides
from pipeline.stage.mistakes import configuration_mistakes

if TYPE_CHECKING:
    from omegaconf import DictConfig

    from pipeline.stage.wrapper import Stage

_LONGEST_NAME = 120


@dataclass
class Job:
    """What a job of a sweep does, in this process or in a worker.

    Attributes:
        stage: what is run.
        sweep: identifies the sweep to which all its jobs belong.
        swept: the keys that differ between the jobs, by which they are called.
    """

    stage: "Stage[Any]"
    sweep: str
    swept: frozenset[str]

    def __call__(self, root: "DictConfig") -> str | None:
        """Run the stage; return a person's mistake, since Hydra prints lines of its own on an exception."""
        from hydra.core.hydra_config import HydraConfig

        name = job_name([text for text in HydraConfig.get().overrides.task if _key(text) in self.swept])
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                target = self.stage.run(plain(root), name, self.sweep)
        except InputError as error:
            return f"{name}: {error}"
        logging.getLogger("simgap").info("%s: wrote %s", self.stage.name, target)
        return None


def run_sweep(stage: "Stage[Any]", overrides: Sequence[str], config_dir: str | None = None) -> None:
    """Run one job per combination of the values that are swept over.

    Raises:
        InputError: when jobs could not be run, after all the others have; every one is named.
    """
    from hydra.core.override_parser.overrides_parser import OverridesParser

    prepared = prepare_overrides(overrides, config_dir)
    with configuration_mistakes():
        parsed = OverridesParser.create().parse_overrides(prepared)
        swept = frozenset(entry.key_or_group for entry in parsed if entry.is_sweep_override())
        job = Job(stage, hash_value([stage.name, *prepared]), swept)
        batches = open_hydra(config_dir).multirun(ROOT_CONFIG, job, prepared, with_log_configuration=True)
    mistakes = [mistake for batch in batches for done in batch if (mistake := done.return_value)]
    for mistake in mistakes[:-1]:
        print(f"simgap {stage.name}: {mistake}", file=sys.stderr)
    if mistakes:
        raise InputError(mistakes[-1])


def job_name(overrides: Sequence[str]) -> str:
    """Return a directory name for the job with these overrides."""
    name = re.sub(r"[^\w.,=+-]", "_", ",".join(text.lstrip("+") for text in overrides)) or "job"
    return name if len(name) <= _LONGEST_NAME else f"{name[:_LONGEST_NAME]}-{hash_value(list(overrides))[:8]}"


def _key(override: str) -> str:
    return override.partition("=")[0].lstrip("+")
