"""What `import simgap` gives, and what it costs."""

import ast
import inspect
import json
import subprocess
import sys
from pathlib import Path

import pytest

import simgap

HEAVY = ["gymnasium", "hydra", "mlflow", "numpy", "omegaconf", "pandas", "scipy", "torch", "yaml"]


def in_a_fresh_process(program: str, folder: Path) -> str:
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_importing_it_is_cheap(tmp_path):
    program = (
        "import sys, time, json; start = time.process_time(); import simgap; "
        f"print(json.dumps([time.process_time() - start, [n for n in {HEAVY} if n in sys.modules]]))"
    )
    seconds, imported = json.loads(in_a_fresh_process(program, tmp_path))
    assert imported == []
    assert seconds < 0.2


@pytest.mark.parametrize("name", simgap.__all__)
def test_every_public_name_is_there_and_documented(name):
    assert name in dir(simgap)
    assert inspect.getdoc(getattr(simgap, name))


def test_type_checkers_see_the_same_names():
    assert simgap.__file__
    module = ast.parse(Path(simgap.__file__).read_text(encoding="utf-8"))
    (block,) = (
        node for node in module.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
    )
    seen = {
        alias.name: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    offered = {name: f"simgap.{module}" for module, names in simgap._WHERE.items() for name in names}
    assert seen == offered
    assert sorted([*seen, "InputError"]) == simgap.__all__
    assert Path(simgap.__file__).with_name("py.typed").exists()


def test_an_unknown_name_is_none():
    with pytest.raises(AttributeError, match="no attribute 'verdict'"):
        _ = simgap.verdict


@pytest.mark.parametrize(
    "imports",
    [
        "import simgap, gymnasium",
        "import gymnasium, simgap",
        "import simgap; from gymnasium import envs; import gymnasium",
        "import simgap; from importlib.util import find_spec; find_spec('gymnasium'); import gymnasium",
    ],
)
def test_gymnasium_knows_the_race_whichever_is_imported_first(imports, tmp_path):
    told = "gymnasium.spec('simgap/Race-v0').entry_point, type(gymnasium.__spec__.loader).__name__"
    program = f"{imports}; print({told})"
    assert in_a_fresh_process(program, tmp_path).split() == ["simgap.api.race:race", "SourceFileLoader"]


def test_gymnasium_finds_the_race_by_the_name_of_the_package(tmp_path):
    program = (
        "import gymnasium\n"
        "try:\n    gymnasium.make('simgap:simgap/Race-v0', track='nowhere')\n"
        "except Exception as error:\n    print(error)\n"
    )
    assert "track: there is no 'nowhere'" in in_a_fresh_process(program, tmp_path)


def test_a_python_without_gymnasium_says_what_any_python_says(tmp_path):
    (tmp_path / "find.py").write_text(
        "import sys, importlib.machinery as m, simgap\n"
        "find = m.PathFinder.find_spec\n"
        "m.PathFinder.find_spec = classmethod(lambda c, n, *a: None if n == 'gymnasium' else find(n, *a))\n"
        "try:\n    import gymnasium\nexcept ModuleNotFoundError as error:\n    print(error)\n"
    )
    assert in_a_fresh_process("import find", tmp_path).strip() == "No module named 'gymnasium'"
