"""A body: a shape of one material with an initial velocity."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from matpoint.checks import instance, numbers, whole
from matpoint.deformed import Start
from matpoint.domains import Domains
from matpoint.errors import InputError
from matpoint.faces import check_sets
from matpoint.fill import fill
from matpoint.grid import Grid
from matpoint.materials import Material
from matpoint.regions import Region


@dataclass(frozen=True, eq=False)
class Body:
    """A region or a mesh of one material.

    Parameters
    ----------
    geometry
        A region, filled with ``per_cell`` particles per cell and axis, or :class:`Domains`, one
        particle each.
    material
        Its material.
    per_cell
        Particles per cell along each axis: one number for all or one each; for regions only.
    velocity
        Initial velocity [m/s], one number per axis, or a function of positions (n, 3) [m] that
        returns (n, 3).
    name
        Used in messages and outputs.
    start
        How it begins deformed; None begins in the reference configuration. ``velocity`` as a function
        takes reference positions all the same.
    """

    geometry: Region | Domains
    material: Material
    per_cell: int | tuple[int, ...] = 2
    velocity: tuple[float, ...] | Callable[[np.ndarray], np.ndarray] = (0.0,)
    name: str = ""
    start: Start | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.geometry, Region | Domains):
            raise InputError(f"{self.label}: geometry = {self.geometry!r} must be a region or Domains")
        if not isinstance(self.material, Material):
            raise InputError(f"{self.label}: material = {self.material!r} must be a material")
        if isinstance(self.geometry, Domains):
            try:
                check_sets(self.geometry)
            except InputError as error:
                raise InputError(f"{self.label}: {error}") from None
        given = self.per_cell if isinstance(self.per_cell, tuple | list) else (self.per_cell,)
        for n in given:
            whole(f"{self.label}: per_cell", n)
        if not callable(self.velocity):
            numbers(f"{self.label}: velocity", self.velocity)
        instance(f"{self.label}: start", self.start, Start | None, "a Start, or None")

    @property
    def label(self) -> str:
        """The name for messages."""
        return f"body {self.name!r}" if self.name else "body"

    def domains(self, grid: Grid) -> Domains:
        """Return the particle domains; a region is filled on the grid's lattice."""
        if isinstance(self.geometry, Domains):
            if self.geometry.dim != grid.dim:
                raise InputError(f"{self.label}: its mesh is {self.geometry.dim}-D, the grid {grid.dim}-D")
            return self.geometry
        count = self.per_cell if isinstance(self.per_cell, tuple | list) else (self.per_cell,) * grid.dim
        if len(count) != grid.dim:
            raise InputError(f"{self.label}: per_cell has {len(count)} numbers, the grid {grid.dim} axes")
        spacing = tuple(h / n for h, n in zip(grid.cell, count, strict=True))
        try:
            return fill(self.geometry, grid.lower, spacing, grid.dim)
        except InputError as error:
            raise InputError(f"{self.label}: {error}") from None

    def initial_velocity(self, positions: np.ndarray, dim: int) -> np.ndarray:
        """Return the initial velocity [m/s] at positions (n, 3) [m] of a run in ``dim`` dimensions."""
        if callable(self.velocity):
            values = np.asarray(self.velocity(positions), dtype=float)
            if values.shape != positions.shape or not np.isfinite(values).all():
                raise InputError(
                    f"{self.label}: velocity must return finite values of shape {positions.shape}"
                )
            return values
        if len(self.velocity) > dim:
            raise InputError(f"{self.label}: velocity has {len(self.velocity)} numbers, the grid {dim} axes")
        values = np.zeros(3)
        values[: len(self.velocity)] = self.velocity
        return np.broadcast_to(values, positions.shape)
