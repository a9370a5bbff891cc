"""Enriched CPDI2: vertices at material interfaces are degrees of freedom (S, section 4)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from matpoint.errors import InputError
from matpoint.interpolation.contract import Interpolation, Mapping, Setting
from matpoint.interpolation.cpdi import ConvectedVertices, check_policy


def interface_vertices(connectivity: np.ndarray, material: np.ndarray, count: int, layers: int) -> np.ndarray:
    """Vertices shared by particles of different materials, and those of ``layers`` layers around.

    Parameters
    ----------
    connectivity
        Vertices of each particle, shape (n, K), padded with -1.
    material
        Material of each particle, shape (n,).
    count
        The number of vertices.
    layers
        How many layers of particles on both sides bring their vertices too.

    Returns
    -------
    ndarray of int64
        In ascending order; triple junctions and any number of materials follow from the rule.
    """
    used = connectivity >= 0
    vertex = connectivity[used]
    owner = np.broadcast_to(material[:, None], connectivity.shape)[used]
    lowest, highest = np.full(count, np.iinfo(np.int64).max), np.full(count, -1)
    np.minimum.at(lowest, vertex, owner)
    np.maximum.at(highest, vertex, owner)
    chosen = highest > lowest
    for _ in range(layers):
        touching = (chosen[connectivity] & used).any(axis=1)
        chosen[connectivity[touching][used[touching]]] = True
    return np.flatnonzero(chosen)


@dataclass(frozen=True)
class EnrichedCPDI2(Interpolation):
    """CPDI2 with interface vertices as degrees of freedom of their own.

    Without it, a stiff and a soft material in one cell share one strain and their stresses differ
    by the ratio of their moduli.

    Parameters
    ----------
    layers
        0 enriches the vertices shared by particles of different materials; n also those of the n
        nearest layers of particles on both sides.
    on_inversion
        As for :class:`~matpoint.interpolation.cpdi.CPDI2`.

    Raises
    ------
    InputError
        If ``layers`` is not a whole number >= 0.
    """

    layers: int = 0
    on_inversion: str = "stop"
    uses_vertices: ClassVar[bool] = True
    citation: ClassVar[tuple[str, ...]] = ("sulsky1994", "sadeghirad2011", "sadeghirad2013")

    def __post_init__(self) -> None:
        if isinstance(self.layers, bool) or not isinstance(self.layers, int) or self.layers < 0:
            raise InputError(f"EnrichedCPDI2: layers = {self.layers!r} must be a whole number, 0 or more")
        check_policy("EnrichedCPDI2", self.on_inversion)

    @property
    def name(self) -> str:
        return "enriched-cpdi2"

    def bind(self, setting: Setting) -> Mapping:
        chosen = interface_vertices(
            setting.connectivity, setting.particles.material, len(setting.vertices), self.layers
        )
        return ConvectedVertices(setting, chosen, self.on_inversion)
