"""Floor 0: recordings as the contract names them, where they come from and how they are brought in."""

from simgap.recordings.recording import Recording, read_recording, require_kind, write_recording

__all__ = ["Recording", "read_recording", "require_kind", "write_recording"]
