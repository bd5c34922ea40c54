import subprocess
import sys

import pytest

from simgap.artifacts import PROJECT_ROOT
from tools.tutorial import plain_page

SCRIPT = """# %% [markdown]
# # Title

# %%
import matplotlib.pyplot as plt
import pandas as pd
from pathlib import Path

x = 20
Path("log.csv").write_text("a")
print("said")
x + 1

# %%
_ = plt.figure()

# %%
pd.DataFrame({"column": [x]})

# %% tags=["remove-cell"]
assert x == 20
print("hidden")
"""


def run(folder, script):
    (folder / "way.py").write_text(script)
    command = [sys.executable, "-m", "tools.tutorial", "way.py", "page"]
    environment = {"PYTHONPATH": str(PROJECT_ROOT), "MPLBACKEND": "Agg", "PATH": ""}
    return subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)


@pytest.mark.slow
def test_a_page_shows_what_each_cell_printed_returned_and_drew(tmp_path):
    done = run(tmp_path, SCRIPT)
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "page" / "way.md").read_text()
    assert page.startswith("# Title\n\n```python\nimport matplotlib")
    assert "```text\nsaid\n```\n\n```text\n21\n```" in page
    assert '<div class="output">' in page
    assert "<td>20</td>" in page
    assert "<style" not in page
    assert "hidden" not in page
    (figure,) = (tmp_path / "page").glob("*.svg")
    assert f"_ = plt.figure()\n```\n\n![]({figure.name})" in page
    assert (tmp_path / "log.csv").exists()


def test_a_cell_that_fails_is_named_by_its_line_and_leaves_no_page(tmp_path):
    done = run(tmp_path, "# %%\nx = 1\n\n# %%\n\nx / 0\n")
    assert done.returncode == 1
    assert "way.py:6: this cell failed" in done.stderr
    assert "ZeroDivisionError" in done.stderr
    assert not (tmp_path / "page" / "way.md").exists()


def test_the_page_of_a_script_that_is_not_run_has_no_output(tmp_path):
    script = tmp_path / "way.py"
    script.write_text("# %%\nprint(1)\n")
    assert plain_page(script) == "```python\nprint(1)\n```\n"
