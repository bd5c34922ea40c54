"""Read a script of which some cells are prose: the percent format of jupytext, which notebooks open too."""

import re
from dataclasses import dataclass

_MARK = re.compile(r"^# %%[^\S\n]*(\[markdown\])?(.*)\n", re.MULTILINE)
_HIDDEN = "remove-cell"  # the tag of a cell that is run but not shown, as Jupyter Book has it


@dataclass(frozen=True)
class Cell:
    """A cell of a script: Python, or prose in Markdown.

    Attributes:
        text: prose without its comment signs.
        is_prose: whether it is no Python.
        line: of the file, at which the text begins.
        is_hidden: whether a page leaves it out, such as checks of what the page says.
    """

    text: str
    is_prose: bool
    line: int
    is_hidden: bool = False


def cells(script: str) -> list[Cell]:
    """Return the cells of a script in their order, without empty ones; what stands above the first mark is left out."""
    marks = list(_MARK.finditer(script))
    ends = [mark.start() for mark in marks[1:]] + [len(script)]
    found = []
    for mark, end in zip(marks, ends, strict=False):  # a script without marks has an end, too
        text, is_prose = script[mark.end() : end], mark[1] is not None
        line = script.count("\n", 0, mark.end()) + 1 + len(text) - len(text.lstrip("\n"))
        text = text.strip("\n")
        if text:
            found.append(Cell(_uncommented(text) if is_prose else text, is_prose, line, _HIDDEN in mark[2]))
    return found


def as_markdown(script: str) -> str:
    """Return a script as a page: its prose, and its Python as blocks of code."""
    shown = [each for each in cells(script) if not each.is_hidden]
    return "\n\n".join(each.text if each.is_prose else code_block(each.text) for each in shown) + "\n"


def code_block(code: str, language: str = "python") -> str:
    """Return code as a block of Markdown."""
    return f"```{language}\n{code}\n```"


def _uncommented(text: str) -> str:
    return "\n".join(re.sub(r"^# ?", "", line) for line in text.split("\n"))
