"""Floor 0: recordings in the names of the contract, their import, cleaning and storage."""

from typing import TYPE_CHECKING

from simgap.lazy import imported_late

if TYPE_CHECKING:
    from simgap.recordings.recording import Recording, read_recording, require_kind, write_recording

__all__ = ["Recording", "read_recording", "require_kind", "write_recording"]

# Whoever needs settings alone does not wait for pandas.
__getattr__ = imported_late(__name__, recording=__all__)
