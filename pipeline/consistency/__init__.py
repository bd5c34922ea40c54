"""Check of a recording against itself and the platform, before anything is named."""

from typing import TYPE_CHECKING

from simgap.lazy import imported_late

if TYPE_CHECKING:
    from simgap.consistency.decide import check, contradictions
    from simgap.consistency.gearing import gear_doubts
    from simgap.consistency.size import size_doubts

__all__ = ["check", "contradictions", "gear_doubts", "size_doubts"]

# Whoever reads a recording alone does not wait for the check.
__getattr__ = imported_late(
    __name__, decide=("check", "contradictions"), gearing=("gear_doubts",), size=("size_doubts",)
)
