"""Probes: particles followed by where they begin."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from matpoint.errors import InputError

if TYPE_CHECKING:
    from matpoint.simulation import Simulation

_VECTOR = {"x": 0, "y": 1, "z": 2}
_TENSOR = {"xx": 0, "yy": 1, "zz": 2, "xy": 3, "yz": 4, "xz": 5}
FIELDS = {
    "position": ("m", _VECTOR),
    "displacement": ("m", _VECTOR),
    "velocity": ("m/s", _VECTOR),
    "stress": ("Pa", _TENSOR),
}


_FAR = 1.5  # domain sizes from a particle, beyond which a probe does not mean it


def _domain_size(sim: Simulation, index: int) -> float:
    """The longest side of a particle's domain at the start [m]."""
    if sim.vertices is not None:
        v = sim.vertices
        corners = v.position0[v.connectivity[index, : v.count[index]]]
        return float((corners.max(axis=0) - corners.min(axis=0)).max())
    cell = sim.grid.cell
    mean = float(np.prod(cell)) ** (1.0 / sim.dim)
    return float(sim.particles.volume0[index]) ** (1.0 / sim.dim) * max(cell) / mean


@dataclass(frozen=True)
class Probe:
    """A particle followed in one component of one field.

    Parameters
    ----------
    name
        Label in the output.
    at
        Initial position [m]; the particle nearest to it is followed.
    field
        ``position``, ``displacement``, ``velocity`` or ``stress``.
    component
        ``x``, ``y``, ``z``, or for stress ``xx``, ``yy``, ``zz``, ``xy``, ``yz``, ``xz``.
    """

    name: str
    at: tuple[float, ...]
    field: str = "displacement"
    component: str = "x"

    def __post_init__(self) -> None:
        if self.field not in FIELDS:
            raise InputError(f"probe {self.name!r}: field = {self.field!r}; {', '.join(FIELDS)} are allowed")
        allowed = FIELDS[self.field][1]
        if self.component not in allowed:
            raise InputError(
                f"probe {self.name!r}: component = {self.component!r}; {', '.join(allowed)} are allowed"
            )
        if not 1 <= len(self.at) <= 3 or not np.isfinite(self.at).all():
            raise InputError(f"probe {self.name!r}: at = {list(self.at)} must be 1 to 3 finite numbers")

    @property
    def column(self) -> str:
        """The column's name."""
        return f"{self.name}.{self.field}.{self.component}"

    def find(self, sim: Simulation) -> int:
        """Return the id of the particle that it follows.

        Raises
        ------
        InputError
            If the nearest particle is farther than 1.5 times the size of its domain.
        """
        p, at = sim.particles, np.zeros(3)
        at[: len(self.at)] = self.at
        gap = ((p.position0 - at) ** 2).sum(axis=1)
        nearest = gap <= gap.min() * (1 + 1e-9) + 1e-30
        found = int(np.flatnonzero(nearest)[p.id[nearest].argmin()])
        distance, size = float(np.sqrt(gap[found])), _domain_size(sim, found)
        if distance > _FAR * size:
            where = ", ".join(f"{x:.6g}" for x in p.position0[found, : sim.dim])
            raise InputError(
                f"probe {self.name!r}: at = {list(self.at)} is outside every body; the nearest particle,"
                f" at [{where}], is {distance:.4g} m away, its domain {size:.4g} m long"
            )
        return int(p.id[found])

    def read(self, sim: Simulation, index: int) -> float:
        """Return the value at the particle with an internal index."""
        p, k = sim.particles, FIELDS[self.field][1][self.component]
        if self.field == "displacement":
            return float(p.position[index, k] - p.position0[index, k])
        return float(getattr(p, self.field)[index, k])
