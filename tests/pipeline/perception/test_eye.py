"""Machines in flight that read the images of their cameras, without a trained network: gates are light in the dark."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
import torch

from simgap.perception.chain import Chain
from simgap.perception.detector import Detector
from simgap.perception.eye import Eye, Eyes
from tests.pipeline.perception.eyes import perception
from tests.pipeline.perception.scenes import CLEAN, dark, gates_at

PX = 160
TRACK = gates_at([7.0, 10.0])
STEP = 0.01  # s
SETTINGS = replace(
    perception(),
    camera=replace(perception().camera, image=[PX, PX], pitch=0.0),
    images=replace(CLEAN, exposures=4),
)


class InTheDark(Eye):
    """An eye in a world without light but that of gates, which finds their openings: holes in what is light."""

    def scene(self, track, position, random):
        motion = type("Motion", (), {"position": position})
        return dark(track, motion, self.settings.images)  # type: ignore[arg-type]

    def found(self, images):
        return [np.array([_square(hole) for hole in _holes(image[0].numpy())]) for image in images]


def _holes(image):
    light = (image > 0.5).astype(np.uint8)
    outlines, tree = cv2.findContours(light, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    inner = [outline for outline, links in zip(outlines, tree[0], strict=True) if links[3] >= 0]
    return [hole for hole in inner if cv2.contourArea(hole) > 60.0]


def _square(hole):
    """Return the corners of the smallest rectangle around a hole, in order; OpenCV's outline is of the light pixels."""
    corners = cv2.boxPoints(cv2.minAreaRect(hole)).astype(float)
    inwards = corners.mean(0) - corners
    return corners + 0.7 * inwards / np.linalg.norm(inwards, axis=-1, keepdims=True)


def eyes(seed=0):
    return Eyes(InTheDark(Detector(SETTINGS.detector), SETTINGS, "cpu"), TRACK, seed)


def at(*distances):
    """Return machines at rest, before the first gate."""
    states = np.zeros((len(distances), 13))
    states[:, 0] = 7.0 - np.array(distances)
    states[:, 2], states[:, 6] = 2.0, 1.0
    return states


def test_odometry_that_drifts_is_corrected_by_rendered_images():
    """Velocity is misjudged by 3 m/s along x, and by half as much to the side."""
    flying = np.stack([at(7.0 - 6.0 * STEP * step, 7.5 - 6.0 * STEP * step) for step in range(60)])
    flying[..., 3] = 6.0
    drift = np.arange(1, 61)[:, None] * STEP * np.array([3.0, 1.5, 0.0])
    believed = flying.copy()
    believed[..., :3] += drift[:, None]
    chain = Chain(eyes(), SETTINGS, TRACK, 2, STEP, seed=0)
    left = np.stack([chain.corrected(*now) for now in zip(flying, believed, strict=True)]) - flying
    alone, corrected = (np.sqrt((each**2).sum(-1).mean()) for each in (drift, left[..., :3]))
    assert chain.counts["images"].tolist() == [15, 15]
    assert chain.counts["gates_believed"].min() >= 15
    assert corrected < 0.2 * alone


def test_the_image_of_a_machine_is_of_its_own_place():
    width = [max(float(np.ptp(gate[:, 0])) for gate in gates) for gates in eyes()(at(2.0, 5.0))]
    angles = [2.0 * np.arctan(0.5 * TRACK.opening / distance) for distance in (2.0, 5.0)]
    assert width[0] / width[1] == pytest.approx(angles[0] / angles[1], rel=0.15)


def test_worlds_stand_still_and_images_are_those_of_their_seed():
    settings = replace(SETTINGS, images=replace(perception().images, exposures=1, blur=[0.0, 0.0]))
    still = replace(settings.images, gain=[1.0, 1.0], shot=[0.0, 0.0], read=[0.0, 0.0], vignetting=[0.0, 0.0])
    settings = replace(settings, images=still)

    def looks(seed):
        torch.manual_seed(0)
        seen = Eyes(Eye(Detector(settings.detector), settings, "cpu"), TRACK, seed)
        images = []
        for _ in range(2):
            seen(at(3.0, 3.0))
            images.append(seen.images)
        return images

    first, second = looks(0)
    assert torch.equal(first, second)
    assert not torch.equal(first[0], first[1])  # each machine has a world of its own
    assert torch.equal(first, looks(0)[0])
    assert not torch.equal(first, looks(1)[0])
