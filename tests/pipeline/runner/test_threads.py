import subprocess
import sys

import pytest

CODE = """
import sys
from simgap.runner.threads import one_thread
{first}
{second}
import torch
sys.exit(torch.get_num_threads())
"""


@pytest.mark.parametrize("statements", [("one_thread()", "import torch"), ("import torch", "one_thread()")])
def test_one_thread_whether_torch_is_loaded_or_not(statements, monkeypatch):
    for name in ("OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        monkeypatch.delenv(name, raising=False)
    code = CODE.format(first=statements[0], second=statements[1])
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 1
