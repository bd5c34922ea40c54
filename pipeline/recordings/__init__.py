"""Floor 0: recordings in the names of the contract, their import, cleaning and storage."""

from simgap.recordings.recording import Recording, read_recording, require_kind, write_recording

__all__ = ["Recording", "read_recording", "require_kind", "write_recording"]
