"""Show a tutorial as a page: the prose, the Python and, where it is run, what each cell printed and drew.

python -m tools.tutorial docs/tutorials/servo.py build/tutorials        # run here, in the folder it is called from
"""

import argparse
import ast
import contextlib
import io
import re
import sys
import traceback
from pathlib import Path
from typing import Any

from tools.percent import Cell, as_markdown, cells, code_block

# Of a table of pandas; the site has its own.
_STYLE = re.compile(
    r'<style.*?</style>| border="1"| class="dataframe"| style="text-align: right;"', re.DOTALL
)


def write_page(script: Path, folder: Path) -> None:
    """Run a script and write its page and figures; what the script writes lies in the working directory.

    Raises:
        SystemExit: where a cell fails, naming the line.
    """
    folder.mkdir(parents=True, exist_ok=True)
    sys.argv, names = [str(script)], {"__name__": "__main__", "__file__": str(script)}
    parts = []
    for each in cells(script.read_text(encoding="utf-8")):
        shown = [each.text if each.is_prose else code_block(each.text)]
        if not each.is_prose:
            shown += _output(each, script, names)
            shown += _figures(folder, f"{script.stem}_{each.line}")
        parts += [] if each.is_hidden else shown
    (folder / f"{script.stem}.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def plain_page(script: Path) -> str:
    """Return the page of a script that is not run."""
    return as_markdown(script.read_text(encoding="utf-8"))


def _output(cell: Cell, script: Path, names: dict[str, Any]) -> list[str]:
    printed = io.StringIO()
    try:
        with contextlib.redirect_stdout(printed):
            value = _run(cell, script, names)
            shown = [] if value is None else [_shown(value)]
    except Exception:
        sys.exit(f"{script}:{cell.line}: this cell failed\n{traceback.format_exc()}")
    parts = [code_block(printed.getvalue().rstrip(), "text")] if printed.getvalue().strip() else []
    return [*parts, *shown]


def _run(cell: Cell, script: Path, names: dict[str, Any]) -> Any:
    """Run a cell and return the value of the expression it ends with, as a notebook shows it, or None."""
    tree = ast.parse("\n" * (cell.line - 1) + cell.text)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, script, "exec"), names)
    return (
        eval(compile(ast.Expression(last.value), script, "eval"), names)
        if isinstance(last, ast.Expr)
        else None
    )


def _shown(value: Any) -> str:
    if hasattr(value, "_repr_html_"):
        unstyled = _STYLE.sub("", value._repr_html_())
        lines = (line for line in unstyled.splitlines() if line.strip())
        return "\n".join(['<div class="output">', *lines, "</div>"])
    return code_block(repr(value), "text")


def _figures(folder: Path, name: str) -> list[str]:
    """Save and close the figures that are open; return the lines that show them."""
    pyplot: Any = sys.modules.get("matplotlib.pyplot")
    lines = []
    for number in pyplot.get_fignums() if pyplot else []:
        file = f"{name}_{number}.svg"
        pyplot.figure(number).savefig(folder / file, bbox_inches="tight")
        lines.append(f"![]({file})")
        pyplot.close(number)
    return lines


if __name__ == "__main__":
    parser = argparse.ArgumentParser(prog="python -m tools.tutorial", description=__doc__.splitlines()[0])
    parser.add_argument("script", type=Path)
    parser.add_argument("folder", type=Path, help="of the page and its figures")
    given = parser.parse_args()
    write_page(given.script.resolve(), given.folder.resolve())
