"""Bringing bodies that begin deformed from their reference configuration to where they begin."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from matpoint.body import Body
from matpoint.errors import InputError
from matpoint.interpolation.contract import Mapping, ParticleError, Setting
from matpoint.materials import stress_kernel

_APART = 1e-6  # of a cell: how far bodies may put a corner that they share


def begin(setting: Setting, mapping: Mapping, bodies: Sequence[Body]) -> bool:
    """Take the particles and domains of all bodies to their start; return whether any begins deformed.

    Everything has been set up and bound in the reference configuration. Particles and corners are then sent
    to their first places as a step sends them, so that every interpolation brings its domains along by
    its own rule: boxes stretch, parallelepipeds follow F, shared corners lie where the map puts them and
    their particles at the domains' centroids.

    Parameters
    ----------
    setting, mapping
        The reference configuration, and the interpolation bound to it.
    bodies
        In the order of ``particles.body``.

    Raises
    ------
    InputError
        If a material has a memory, so that F alone does not give its stress; a start is not finite, turns
        material over or leaves the grid; or two bodies put a shared corner in two places.
    """
    if all(body.start is None for body in bodies):
        return False
    p = setting.particles
    position, corners = p.position0.copy(), setting.vertices.copy()
    placed = np.zeros(len(corners), dtype=bool)
    for number, body in enumerate(bodies):
        mine = np.flatnonzero(p.body == number).astype(np.int32)
        cells = setting.connectivity[mine]
        used = np.unique(cells[cells >= 0])
        target = setting.vertices[used]
        if body.start is not None:
            position[mine] = body.start.place(p.position0[mine], body.label)
            p.deformation_gradient[mine] = body.start.stretch(p.position0[mine], body.label)
            _stress(setting, mine, body)
            target = body.start.place(target, body.label)
            _inside(setting, np.concatenate([target, position[mine]]), body)
        gap = np.abs(target - corners[used])[placed[used]]
        if gap.size and gap.max() > _APART * setting.grid.finest:
            raise InputError(f"{body.label}: its start moves a corner away from the body that shares it")
        corners[used], placed[used] = target, True
    _send(setting, mapping, position, corners)
    return True


def _stress(setting: Setting, mine: np.ndarray, body: Body) -> None:
    """Volume and Cauchy stress of particles from their F, by the law itself with no motion."""
    if body.material.state_variables:
        names = ", ".join(body.material.state_variables)
        raise InputError(f"{body.label}: its material has a memory ({names}); it can't begin deformed")
    p = setting.particles
    rest = np.zeros_like(p.deformation_gradient)
    bad = stress_kernel(body.material)(
        mine, 0, len(mine), p.deformation_gradient, 0, rest, p.volume0, p.volume, p.state, p.stress, 0.0
    )
    if bad >= 0:
        raise InputError(f"{body.label}: its start gives particle {p.id[bad]} no finite stress")


def _inside(setting: Setting, points: np.ndarray, body: Body) -> None:
    grid = setting.grid
    for k in range(grid.dim):
        low, high = float(points[:, k].min()), float(points[:, k].max())
        hair = 1e-6 * grid.cell[k]
        if low < grid.lower[k] - hair or high > grid.upper[k] + hair:
            raise InputError(
                f"{body.label} begins from {low:g} to {high:g} along {'xyz'[k]}, outside the grid"
                f" ({grid.lower[k]:g} to {grid.upper[k]:g})"
            )


def _send(setting: Setting, mapping: Mapping, position: np.ndarray, corners: np.ndarray) -> None:
    """Let the mapping take places as the next ones of a step."""
    grid = setting.grid
    for k in range(grid.dim):  # rounding may put a point a hair out of the box
        np.clip(position[:, k], grid.lower[k], grid.upper[k], out=position[:, k])
    following = getattr(mapping, "position_next", None)
    if following is None:
        setting.particles.position[:] = position
    elif len(following):  # else particles are where their corners are
        following[:] = position
    vertices = mapping.vertices
    if vertices is not None and len(vertices) == len(corners):
        vertices.position_next[:] = corners
    try:
        if following is not None:
            mapping.advance()
    except ParticleError as fault:
        raise InputError(
            f"start: particle {int(setting.particles.id[fault.particle])}: {fault.cause}"
        ) from None
