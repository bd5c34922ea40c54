"""What works in a clone of the repository only."""

from collections.abc import Callable

import pytest

from simgap.artifacts import CHECKOUT, project, require_checkout
from simgap.errors import InputError
from simgap.runner import StageRun
from simgap.stages.calibrate import CalibrateStage, calibrate
from simgap.stages.prove import prove
from simgap.stages.reproduce import reproduce
from simgap.stages.results import results


def test_a_clone_is_given_as_it_is() -> None:
    assert require_checkout() == CHECKOUT


def _calibrate() -> None:
    config = CalibrateStage()
    config.prove.write_calibration = True
    calibrate(config, StageRun("nowhere"))


def _prove() -> None:
    config = prove.config_class()
    config.prove.write_docs = True
    prove(config, StageRun("nowhere"))


@pytest.mark.parametrize("command", [reproduce, lambda: results([]), _calibrate, _prove])
def test_an_installation_is_refused_before_any_work(
    command: Callable[[], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(project, "CHECKOUT", None)
    with pytest.raises(InputError, match=r"works in a clone of the repository only, .*; clone it"):
        command()
