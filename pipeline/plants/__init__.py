"""The concealed plants: machines richer than the catalogue, flown in closed loop and recorded with noise.

Nothing that identifies, diagnoses or simulates may look in here; only the stages `record` and `deploy` do.
"""

from simgap.plants.kinds import CASES, case_from_config, record_case

__all__ = ["CASES", "case_from_config", "record_case"]
