"""One thread per process, where processes run in parallel."""

import os
import sys


def one_thread() -> None:
    """Limit this process to one thread, so that results do not depend on the number of processes."""
    os.environ |= {"OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    if "torch" in sys.modules:
        sys.modules["torch"].set_num_threads(1)
