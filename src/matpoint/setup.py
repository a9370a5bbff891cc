"""From bodies to particles: filling, checking, merging, sorting."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from matpoint import measures
from matpoint.assembly import merge, overlap, overlap_within
from matpoint.body import Body
from matpoint.domains import Domains
from matpoint.errors import InputError
from matpoint.grid import Grid
from matpoint.interpolation.contract import Setting
from matpoint.materials import Material
from matpoint.particles import MOST, Particles
from matpoint.sorting import cell_order
from matpoint.threads import BLOCK, Team


def distinct_materials(bodies: Sequence[Body]) -> tuple[list[Material], list[int]]:
    """Return the distinct materials in order of first use, and each body's index among them."""
    materials: list[Material] = []
    index = []
    for body in bodies:
        if body.material not in materials:
            materials.append(body.material)
        index.append(materials.index(body.material))
    return materials, index


def _check_inside(grid: Grid, body: Body, domains: Domains) -> None:
    for k in range(grid.dim):
        low, high = float(domains.vertices[:, k].min()), float(domains.vertices[:, k].max())
        hair = 1e-6 * grid.cell[k]
        if low < grid.lower[k] - hair or high > grid.upper[k] + hair:
            raise InputError(
                f"{body.label} reaches from {low:g} to {high:g} along {'xyz'[k]}, outside the grid"
                f" ({grid.lower[k]:g} to {grid.upper[k]:g})"
            )


def _check_places(grid: Grid, bodies: Sequence[Body], parts: Sequence[Domains], names: Sequence[str]) -> None:
    """Refuse bodies that reach out of the grid, and domains in one place."""
    for body, domains in zip(bodies, parts, strict=True):
        if body.start is None:  # else where it begins is what counts
            _check_inside(grid, body, domains)
    overlap(list(zip(names, parts, strict=True)))
    for name, domains in zip(names, parts, strict=True):
        overlap_within(name, domains)


def make_setting(grid: Grid, bodies: Sequence[Body], team: Team) -> tuple[Setting, list[Material]]:
    """Return particles in order of cell, their domains, and the list of materials.

    Raises
    ------
    InputError
        If there are no bodies, a body reaches out of the grid, or two lie in one place.
    """
    if not bodies:
        raise InputError("simulation: no bodies, so no particles; give at least one")
    if len(bodies) > MOST:
        raise InputError(f"simulation: {len(bodies)} bodies; at most {MOST} are possible")
    parts = [body.domains(grid) for body in bodies]
    names = [body.name or f"number {k}" for k, body in enumerate(bodies)]
    _check_places(grid, bodies, parts, names)
    materials, chosen = distinct_materials(bodies)
    joined = merge(parts, names)
    del parts  # filled regions are held by nothing else
    measured = measures.measured(
        measures.volumes_and_centroids, joined.vertices, joined.cells, joined.kind, (4,)
    )
    particles = Particles(len(joined.body), max(len(m.state_variables) for m in materials))
    particles.body[:] = joined.body
    particles.volume0[:], particles.position[:] = measured[:, 0], measured[:, 1:]
    stiffness = np.zeros(len(particles))
    edges = np.searchsorted(joined.body, np.arange(len(bodies) + 1))
    for body, material, a, b in zip(bodies, chosen, edges[:-1], edges[1:], strict=True):
        particles.material[a:b] = material
        _begin(particles, slice(a, b), body, grid.dim)
        with np.errstate(all="ignore"):
            speed = body.material.wave_speed(np.eye(3)[None])[0]
        if not np.isfinite(speed):
            raise InputError(
                f"{body.label}: the wave speed of its material is {speed:g} m/s; are moduli [Pa] and density"
                " [kg/m³] right?"
            )
        stiffness[a:b] = body.material.density * speed**2
    particles.position0[:] = particles.position
    particles.volume[:] = particles.volume0
    setting = Setting(
        grid=grid,
        particles=particles,
        team=team,
        vertices=joined.vertices,
        connectivity=joined.cells,
        kind=joined.kind,
        facets=joined.facets,
        stiffness=stiffness,
    )
    return _sorted(setting), materials


def _begin(particles: Particles, rows: slice, body: Body, dim: int) -> None:
    """Give the particles of a body their velocity, mass and state."""
    particles.velocity[rows, :dim] = body.initial_velocity(particles.position[rows], dim)[:, :dim]
    particles.mass[rows] = body.material.density * particles.volume0[rows]
    initial = list(body.material.state_variables.values())
    particles.state[rows, : len(initial)] = initial


def _sorted(setting: Setting) -> Setting:
    """Put particles and vertices in order of cell, so that neighbours in space are so in memory."""
    order = cell_order(setting.team, setting.grid, setting.particles.position)
    if order is not None:
        setting.particles.permute(order, setting.team)
        setting.kind = setting.kind[order]
        setting.stiffness = setting.stiffness[order]
        setting.connectivity = setting.connectivity[order]
    order = cell_order(setting.team, setting.grid, setting.vertices)
    if order is None:
        setting.vertices = setting.vertices.copy()  # they may be the body's own
    else:
        rank = np.empty(len(order) + 1, dtype=np.int32)
        rank[order] = np.arange(len(order), dtype=np.int32)
        rank[-1] = -1  # the padding of short cells, index -1
        setting.vertices = setting.vertices[order]
        setting.facets = tuple(replace(f, corners=rank[f.corners].astype(np.int64)) for f in setting.facets)
        for start in range(0, len(setting.connectivity), BLOCK):
            some = setting.connectivity[start : start + BLOCK]
            some[:] = rank[some]
    return setting
