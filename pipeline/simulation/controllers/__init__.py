"""Flight controllers of simulated machines: from the action of a policy to actuator commands."""

from simgap.simulation.controllers.betaflight import Betaflight

__all__ = ["Betaflight"]
