"""What the site adds to mkdocs, which mkdocs.yml names: it shows the tutorials, which are scripts, as pages.

A page of docs links to a tutorial's script, which is there in a checkout. On the site the link leads to the page.
"""

import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[1]
SCRIPT = re.compile(
    r"(\]\((?:\.\./)*tutorials/\w+)\.py\b"
)  # a link to a tutorial, from any page but a tutorial
RUN = "SIMGAP_RUN_TUTORIALS"  # set: run each tutorial and show what it gives; it takes minutes


def on_files(files: Files, config: Any, **_: Any) -> Files:
    """Add a page, and its figures, for each tutorial."""
    for script in sorted(Path(config.docs_dir, "tutorials").glob("*.py")):
        for name, content in _pages(script).items():
            files.append(File.generated(config, f"tutorials/{name}", content=content))
    return files


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Make links to the scripts of tutorials lead to their pages."""
    return SCRIPT.sub(r"\1.md", markdown)


def _pages(script: Path) -> dict[str, bytes]:
    sys.path.insert(0, str(ROOT))  # mkdocs loads a hook as a file, not as a part of tools
    from tools.tutorial import plain_page

    if not os.environ.get(RUN):
        return {f"{script.stem}.md": plain_page(script).encode()}
    print(f"running {script.name}", file=sys.stderr)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch, "page")
        command = [sys.executable, "-m", "tools.tutorial", str(script), str(folder)]
        found = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH")]))
        environment = {**os.environ, "PYTHONPATH": found, "MPLBACKEND": "Agg", "OMP_NUM_THREADS": "1"}
        done = subprocess.run(command, cwd=scratch, env=environment, capture_output=True, text=True)
        if done.returncode:
            raise PluginError(done.stderr)
        return {path.name: path.read_bytes() for path in folder.iterdir()}
