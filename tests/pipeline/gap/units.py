"""One machine in other units: what is said of it may not change."""

from dataclasses import replace

from simgap.platforms import Joint
from simgap.recordings.recording import Recording
from simgap.simulation import Simulator
from tests.pipeline.gap.recordings import GAIN, JOINT


def driven_by_effort(recording: Recording) -> tuple[Recording, Simulator]:
    """Return the recording of a motor's joint with the effort of the motor in place of its voltage."""
    frame = recording.frame
    effort = GAIN * (frame["voltage"] - GAIN * frame["velocity"])
    units = {"position": "rad", "velocity": "rad/s", "effort": "N·m"}
    frame = frame.drop(columns="voltage").assign(effort=effort)
    return replace(recording, frame=frame, units=units), Simulator(Joint(inertia=JOINT.inertia))


def in_units(
    recording: Recording, simulator: Simulator, effort: float = 1.0, travel: float = 1.0
) -> tuple[Recording, Simulator]:
    """Return recording and platform of a joint driven by efforts, with numbers so many times as great.

    Args:
        recording: with position, velocity and effort.
        simulator: of a joint without a motor.
        effort: 1000 for millinewton metres.
        travel: 57.3 for degrees.
    """
    frame = recording.frame.assign(
        position=travel * recording.frame["position"],
        velocity=travel * recording.frame["velocity"],
        effort=effort * recording.frame["effort"],
    )
    platform = simulator.platform
    assert isinstance(platform, Joint)
    inertia = platform.inertia * effort / travel
    return replace(recording, frame=frame), replace(simulator, platform=replace(platform, inertia=inertia))
