"""What the project offers on the command line, read without importing any of it."""

import ast
import difflib
from collections.abc import Iterable

from pipeline.artifacts.project import PROJECT_ROOT

CONFIGURATION = PROJECT_ROOT / "conf"
STAGES = PROJECT_ROOT / "stages"


def commands() -> dict[str, str]:
    """Return the first line of documentation of every command, by name: one per file of `stages/`."""
    return {
        path.stem: _summary(path.stem, ast.parse(path.read_text(encoding="utf-8")))
        for path in sorted(STAGES.glob("*.py"))
        if not path.stem.startswith("_")
    }


def _summary(name: str, module: ast.Module) -> str:
    functions = [node for node in module.body if isinstance(node, ast.FunctionDef) and node.name == name]
    text = ast.get_docstring(functions[0] if functions else module) or ""
    return text.partition("\n")[0]


def nearest(name: str, known: Iterable[str]) -> str:
    """Return what to do about an unknown name: the nearest known one, else all of them."""
    options = sorted(known)
    near = difflib.get_close_matches(name, options, n=1)
    if near:
        return f"did you mean {near[0]!r}?"
    return f"use one of {', '.join(options)}" if options else "nothing can be given here"
