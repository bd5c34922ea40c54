"""The same small recordings as beside, for what is made of files."""

from tests.pipeline.recordings.conftest import frames

__all__ = ["frames"]
