"""DVC without its remarks on its own lock file and on remotes: this project shares neither."""

import logging
import sys
from typing import Any

_REMARK = "Use `dvc push`"


def main(argv: list[str]) -> int:
    """Run DVC's command line and return its exit code."""
    from dvc.cli import main as dvc
    from dvc.ui import ui

    write = ui.write

    def quiet(*objects: Any, **options: Any) -> None:
        if not str(objects[0] if objects else "").startswith(_REMARK):
            write(*objects, **options)

    ui.write = quiet  # type: ignore[method-assign]
    logging.getLogger("dvc.dvcfile").addFilter(lambda record: "lock file" not in record.getMessage())
    return dvc(argv)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
