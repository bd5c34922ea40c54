"""A library that only an extra brings, where it is not installed."""

import re
import tomllib
from pathlib import Path

import pytest

from simgap.errors import InputError
from simgap.extras import missing_launcher, named_extras, require

PROJECT = tomllib.loads(Path(__file__).parents[2].joinpath("pyproject.toml").read_text(encoding="utf-8"))
EXTRAS: dict[str, list[str]] = PROJECT["project"]["optional-dependencies"]
MODULES = {"opencv-python-headless": "cv2", "scikit-learn": "sklearn"}


def libraries(extra: str) -> list[str]:
    return [name for text in EXTRAS[extra] if (name := re.match(r"[\w-]+", text)[0]) != "simgap"]  # type: ignore[index]


def first_with(library: str) -> str:
    return next(extra for extra in EXTRAS if library in libraries(extra))


@pytest.mark.parametrize(
    "library",
    sorted(
        {
            name
            for extra in ("learn", "race", "track", "benchmark", "perception", "pipeline")
            for name in libraries(extra)
        }
    ),
)
def test_the_line_names_the_library_and_the_command(library: str) -> None:
    module = MODULES.get(library, library.replace("-", "_"))
    line = f"needs {library}; pip install 'simgap[{first_with(library)}]'"
    with pytest.raises(InputError) as raised, named_extras():
        raise ModuleNotFoundError(f"No module named '{module}.part'", name=f"{module}.part")
    assert str(raised.value) == line


@pytest.mark.parametrize("name", ["nonsense", "simgap.nonsense", None])
def test_what_no_extra_brings_is_no_mistake_of_a_person(name: str | None) -> None:
    with pytest.raises(ModuleNotFoundError), named_extras():
        raise ModuleNotFoundError("No module", name=name)


def test_what_is_installed_is_not_missed() -> None:
    require("numpy")


def test_what_is_not_installed_is_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("simgap.extras.find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"^needs mlflow; pip install 'simgap\[track\]'$"):
        require("mlflow")


@pytest.mark.parametrize(
    ("option", "extra"), [("joblib", "sweep"), ("submitit_local", "cluster"), ("submitit_slurm", "cluster")]
)
def test_a_launcher_that_is_not_installed(option: str, extra: str) -> None:
    assert str(missing_launcher(option)).endswith(f"pip install 'simgap[{extra}]'")


def test_a_launcher_that_there_is_not() -> None:
    assert missing_launcher("jobslib") is None


def test_all_and_dev_hold_every_extra_of_a_command() -> None:
    (everything,) = EXTRAS["all"]
    assert set(re.findall(r"\w+", everything)) == {"simgap"} | set(EXTRAS) - {"all", "dev", "docs"}
    assert "simgap[all]" in EXTRAS["dev"]
