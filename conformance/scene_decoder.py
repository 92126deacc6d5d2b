# SPDX-License-Identifier: Apache-2.0
"""Chapter 25 of the specification: the decoders of a scene."""
from __future__ import annotations

from typing import Union

from conventions import require
from deformable_decoder import DeformableDecoder
from load import LoadDecoder
from rigid import RigidDecoder
from scene import Declaration, Limits


class SceneDecoder:
    """The decoders of the substreams of a scene, by number."""

    def __init__(self, scene: Declaration, limits: Limits = Limits()):
        self.substreams: dict[int, Union[RigidDecoder, DeformableDecoder, LoadDecoder]] = {}
        for substream in scene.substreams():
            if substream == 0:
                self.substreams[substream] = RigidDecoder(scene, limits)
            elif substream <= len(scene.deformables):
                self.substreams[substream] = DeformableDecoder(scene, scene.deformables[substream - 1], limits)
            else:
                self.substreams[substream] = LoadDecoder(scene, limits)

    def split(self, data: bytes) -> tuple[int, bytes]:
        """The substream of a packet, and the packet without its byte."""
        if len(self.substreams) == 1:
            return next(iter(self.substreams)), data
        require(len(data) >= 1, "truncated", "R-PKT-6")
        require(data[0] in self.substreams, "invalid", "R-PKT-6")
        return data[0], data[1:]
