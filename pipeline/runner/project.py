"""The commands of the project, read without importing them."""

import ast
import difflib
import keyword
import re
from collections.abc import Iterable
from dataclasses import fields

from simgap.artifacts.project import STAGES
from simgap.runner.config import StageConfig


def commands() -> dict[str, str]:
    """Return the first line of documentation of every command, by name: one per file of `stages/`."""
    files = sorted(path.stem for path in STAGES.glob("*.py") if not path.stem.startswith("_"))
    names = [file.removesuffix("_") for file in files]
    return {name: _documentation(_parse(name), name).partition("\n")[0] for name in names}


def file_of(name: str) -> str:
    """Return the name of a command's file and function: its own, with `_` behind a word that Python reserves."""
    return f"{name}_" if keyword.iskeyword(name) else name


def described(name: str) -> tuple[str, list[str]] | None:
    """Return the description of a stage and the keys that it reads; None for a command that is not a stage."""
    module = _parse(name)
    function = _function(module, name)
    decorators = [ast.unparse(entry) for entry in function.decorator_list] if function else []
    if not decorators or not (named := re.match(r"stage\((\w+)", decorators[0])):
        return None
    own = [
        entry.target.id
        for entry in _class(module, named[1]).body
        if isinstance(entry, ast.AnnAssign) and isinstance(entry.target, ast.Name)
    ]
    return _documentation(module, name), [field.name for field in fields(StageConfig)] + own


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the remedy for an unknown name: the nearest known one, else all of them."""
    options = sorted(known)
    near = difflib.get_close_matches(name, options, n=1)
    if near:
        return f"did you mean {near[0]!r}?"
    return f"use one of {', '.join(options)}" if options else "nothing can be given here"


def _parse(name: str) -> ast.Module:
    return ast.parse((STAGES / f"{file_of(name)}.py").read_text(encoding="utf-8"))


def _function(module: ast.Module, name: str) -> ast.FunctionDef | None:
    return next(
        (node for node in module.body if isinstance(node, ast.FunctionDef) and node.name == file_of(name)),
        None,
    )


def _class(module: ast.Module, name: str) -> ast.ClassDef:
    """Return the definition of a class that a stage's file holds, or takes from another one of `stages/`."""
    for node in module.body:
        if isinstance(node, ast.ClassDef) and node.name == name:
            return node
        if isinstance(node, ast.ImportFrom) and name in [entry.name for entry in node.names]:
            return _class(_parse(str(node.module).removeprefix("simgap.stages.")), name)
    raise LookupError(f"there is no class {name} in this file of stages/ nor where it imports from")


def _documentation(module: ast.Module, name: str) -> str:
    return ast.get_docstring(_function(module, name) or module) or ""
