"""Concealed plants: machines with richer physics than the catalogue, in closed loop and with sensor noise.

Nothing that identifies, diagnoses or simulates may look in here; only the stages `record` and `deploy` do.
"""

from simgap.plants.kinds import CASES, case_from_config, record_case

__all__ = ["CASES", "case_from_config", "record_case"]
