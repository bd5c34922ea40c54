"""What flies a simulated machine: from the action of a policy to the command of its actuators."""

from simgap.simulation.controllers.betaflight import Betaflight

__all__ = ["Betaflight"]
