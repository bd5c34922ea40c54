"""How modules import each other, read from their text: at the top, in functions and for the type checker alike."""

import ast
from collections.abc import Container, Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

from simgap.artifacts import PROJECT_ROOT

FOLDERS = {"simgap": "pipeline", "simgap.stages": "stages"}


def modules() -> dict[str, Path]:
    """Return the files of the package by the name under which they are imported."""
    found = {}
    for package, folder in FOLDERS.items():
        for path in (PROJECT_ROOT / folder).rglob("*.py"):
            parts = path.relative_to(PROJECT_ROOT / folder).with_suffix("").parts
            found[".".join([package, *(part for part in parts if part != "__init__")])] = path
    return found


def imported(text: str, known: Container[str]) -> Iterator[str]:
    """Yield the known modules that a file imports: `from a import b` means `a.b` where that is one, else `a`."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in known)
        elif isinstance(node, ast.ImportFrom):
            assert node.module, "relative imports are not read here"
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            yield from (name if name in known else node.module for name in names)


def graph(texts: Mapping[str, str]) -> dict[str, set[str]]:
    """Return for each module the others that it imports."""
    return {
        name: {found for found in imported(text, texts) if found in texts} - {name}
        for name, text in texts.items()
    }


def cycle(edges: Mapping[str, set[str]]) -> list[str] | None:
    """Return the modules of one cycle, in the order of its imports, if there is any."""
    try:
        TopologicalSorter(edges).prepare()
    except CycleError as error:
        return list(error.args[1])[::-1]
    return None


def test_no_modules_import_each_other():
    edges = graph({name: path.read_text(encoding="utf-8") for name, path in modules().items()})
    assert len(edges) > 300
    assert sum(map(len, edges.values())) > 1000
    assert cycle(edges) is None


@pytest.mark.parametrize(
    "back",
    [
        "import a.lower",
        "from a import lower",
        "from a.lower import thing",
        "def work():\n    from a.lower import thing",
        "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from a.lower import Thing",
    ],
)
def test_a_cycle_is_found_wherever_it_is_imported(back):
    texts = {"a": "", "a.lower": "from a.upper import thing", "a.upper": back, "b": "import a.upper"}
    found = cycle(graph(texts))
    assert found is not None
    assert set(found) == {"a.lower", "a.upper"}
