"""One thread per process, where processes stand side by side."""

import os
import sys


def one_thread() -> None:
    """Let this process have one thread: the others have theirs, and sums are taken in the same order whoever works."""
    os.environ |= {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    if "torch" in sys.modules:
        sys.modules["torch"].set_num_threads(1)
