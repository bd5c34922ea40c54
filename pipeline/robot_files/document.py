"""An XML document of a stranger: of bounded size and depth, without a document type, so without entities."""

import re
from pathlib import Path
from xml.etree import ElementTree

from simgap.artifacts.bounded import whole_of
from simgap.errors import InputError

_LARGEST = 4  # MB; robot files without their meshes take some hundred kB
_DEEPEST = 100  # elements in one another; the longest arms have some thirty
_DECLARATION = re.compile(r"<!(?!--|\[CDATA\[)")  # <!DOCTYPE, <!ENTITY and the like


def read_document(path: Path) -> ElementTree.Element:
    """Return the root of an XML file.

    Raises:
        InputError: when the file cannot be read, is too large or too deep, is no XML, or declares a document type.
    """
    text = _text(path)
    if _DECLARATION.search(text):
        raise InputError("declares a document type", str(path), "take <!DOCTYPE ...> and its entities out")
    try:
        # A text is parsed as what it is: an encoding that the file declares has no effect.
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise InputError(f"is not XML ({error})", str(path), "correct the file") from error
    _check_depth(root, str(path))
    return root


def _text(path: Path) -> str:
    content = whole_of(path, _LARGEST, "keep meshes in files of their own")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError("is not UTF-8", str(path), "save it as UTF-8") from error


def _check_depth(root: ElementTree.Element, where: str) -> None:
    level, depth = [root], 0
    while level:
        depth += 1
        if depth > _DEEPEST:
            raise InputError(f"has elements nested deeper than {_DEEPEST}", where, "simplify the file")
        level = [child for element in level for child in element]
