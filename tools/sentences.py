"""Say how long the sentences of the documentation are.

python -m tools.sentences README.md docs
"""

import argparse
import re
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from markdown_it import MarkdownIt
from markdown_it.token import Token

from tools.percent import as_markdown

LIMIT = 20.0  # words; a file whose sentences are this long on average, or longer, is refused
_PARSER = MarkdownIt("commonmark").enable("table")
_ABBREVIATIONS = re.compile(r"\b(e\.g|i\.e|etc|vs|cf|Fig|eq|No|approx)\.")
_END = re.compile(
    r"(?<=[.!?])[\"'”’)\]]*\s+(?=[\"'“‘(\[]*[^\Wa-z])"
)  # and the next sentence begins with no small letter
_WORD = re.compile(r"\S*\w\S*")


@dataclass(frozen=True)
class Count:
    """How many sentences and words a text has."""

    sentences: int
    words: int

    @property
    def mean(self) -> float:
        """Words of a sentence on average; 0 where there is none."""
        return self.words / self.sentences if self.sentences else 0.0

    def __add__(self, other: "Count") -> "Count":
        return Count(self.sentences + other.sentences, self.words + other.words)


def count(markdown: str) -> Count:
    """Count the sentences of a text in Markdown, without its code, tables, headings and pictures.

    A sentence ends with a full stop, and with its paragraph or list item. Code within a sentence is one word.
    """
    lengths = [
        len(_WORD.findall(sentence))
        for paragraph in _paragraphs(_PARSER.parse(markdown))
        for sentence in _END.split(_ABBREVIATIONS.sub(r"\1", paragraph))
    ]
    return Count(sum(length > 0 for length in lengths), sum(lengths))


def _paragraphs(tokens: Iterable[Token]) -> Iterator[str]:
    inside = ""
    for token in tokens:
        if token.type in ("paragraph_open", "heading_open", "table_open"):
            inside = inside or token.type
        elif token.type in ("paragraph_close", "heading_close", "table_close"):
            inside = "" if token.type.split("_")[0] == inside.split("_")[0] else inside
        elif token.type == "inline" and inside == "paragraph_open":
            yield "".join(map(_text, token.children or ()))


def _text(token: Token) -> str:
    if token.type in ("softbreak", "hardbreak"):
        return " "
    return {"text": token.content, "code_inline": "Code"}.get(token.type, "")


def files(paths: Iterable[Path]) -> list[Path]:
    """Return the files themselves, and all pages and tutorials below the folders."""
    found: list[Path] = []
    for path in paths:
        within = (each for each in path.rglob("*") if each.suffix in (".md", ".py"))
        found += sorted(within) if path.is_dir() else [path]
    return found


def count_file(path: Path) -> Count:
    """Count the sentences of a page, or of the prose of a tutorial."""
    text = path.read_text(encoding="utf-8")
    return count(as_markdown(text) if path.suffix == ".py" else text)


def main(arguments: list[str] | None = None) -> int:
    """Print a row for each file and one for all; return 1 where one is refused."""
    parser = argparse.ArgumentParser(prog="python -m tools.sentences", description=__doc__.splitlines()[0])
    parser.add_argument("paths", nargs="+", type=Path, help="files, or folders of pages")
    counts = {path: count_file(path) for path in files(parser.parse_args(arguments).paths)}
    print("sentences   words   mean  file")
    for path, each in counts.items():
        print(f"{_row(each)}  {path}{'  too long' if each.mean >= LIMIT else ''}")
    print(f"{_row(sum(counts.values(), Count(0, 0)))}  all")
    return int(any(each.mean >= LIMIT for each in counts.values()))


def _row(each: Count) -> str:
    return f"{each.sentences:9} {each.words:7} {each.mean:6.1f}"


if __name__ == "__main__":
    sys.exit(main())
