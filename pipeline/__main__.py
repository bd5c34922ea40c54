"""The command `simgap`, as `python -m simgap`."""

from simgap.stages.__main__ import main

if __name__ == "__main__":
    main()
