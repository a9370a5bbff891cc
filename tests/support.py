"""Random particles with random deformed domains, and probes of a bound interpolation."""

from __future__ import annotations

import numpy as np

from matpoint.domains import Domains, Kind
from matpoint.grid import Grid
from matpoint.interpolation.contract import Interpolation, Mapping, Setting
from matpoint.meshes import mesh_box
from matpoint.particles import Particles
from matpoint.threads import Team

KIND_OF_DIM = {1: (Kind.LINE,), 2: (Kind.QUAD, Kind.TRI), 3: (Kind.HEX, Kind.TET)}
_SPLIT = {
    Kind.TRI: ((0, 1, 2), (0, 2, 3)),
    Kind.TET: ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)),
}


def grid_of(dim: int) -> Grid:
    """A grid with a different cell size on each axis."""
    return Grid((0.0, -1.0, 2.0)[:dim], (4.0, 3.0, 5.0)[:dim], (0.5, 0.8, 0.75)[:dim])


def deformed_mesh(dim: int, kind: Kind, rng: np.random.Generator, amount: float = 0.2) -> Domains:
    """Domains inside the grid: a box mesh with moved vertices, split if need be, then sheared."""
    grid = grid_of(dim)
    low, high = np.array(grid.lower), np.array(grid.upper)
    a, b = low + 0.25 * (high - low), high - 0.25 * (high - low)
    divisions = (5, 4, 3)[:dim]
    base = mesh_box(tuple(a), tuple(b), divisions)
    x = base.vertices.copy()
    x[:, :dim] += amount * (b - a) / np.array(divisions) * rng.uniform(-0.5, 0.5, (len(x), dim))
    shear = np.eye(dim) + rng.uniform(-0.15, 0.15, (dim, dim))
    centre = 0.5 * (a + b)
    x[:, :dim] = (x[:, :dim] - centre) @ shear.T + centre
    cells = base.cells
    if kind in _SPLIT:
        cells = np.concatenate([base.cells[:, list(part)] for part in _SPLIT[kind]])
    return Domains(x, cells, kind)


def setting_of(domains: Domains, rng: np.random.Generator, materials: int = 2) -> Setting:
    """Particles with random mass, velocity, stress and (slightly) random F in these domains."""
    dim, n = domains.dim, domains.n
    p = Particles(n)
    p.position[:] = domains.centroids()
    p.position0[:] = p.position
    p.velocity[:, :dim] = rng.normal(size=(n, dim))
    p.mass[:] = rng.uniform(0.5, 2.0, n)
    p.volume0[:] = domains.volumes()
    p.volume[:] = p.volume0 * rng.uniform(0.8, 1.2, n)
    p.stress[:] = rng.normal(size=(n, 6))
    p.deformation_gradient[:, :dim, :dim] += rng.uniform(-0.1, 0.1, (n, dim, dim))
    p.material[:] = (p.position[:, 0] > np.median(p.position[:, 0])) * (materials - 1)
    width = domains.cells.shape[1]
    return Setting(
        grid=grid_of(dim),
        particles=p,
        team=Team(1),
        vertices=domains.vertices,
        connectivity=domains.cells.reshape(n, width),
        kind=np.full(n, int(domains.kind)),
        stiffness=rng.uniform(0.5, 2.0, n),
    )


def bind(interpolation: Interpolation, setting: Setting) -> Mapping:
    """Bind, and let domains that follow F take it up."""
    mapping = interpolation.bind(setting)
    mapping.position_next = setting.particles.position.copy()  # type: ignore[attr-defined]
    mapping.advance()
    mapping.before()
    return mapping


def gather_field(mapping: Mapping, setting: Setting, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sum_i phi_ip u_i (n, 3) and sum_i u_i (x) grad phi_ip (n, 3, 3) of nodal values (records, 3)."""
    mapping.nodes.records[:] = 0.0
    mapping.nodes.records[:, :3] = values
    p = setting.particles
    kept = p.velocity.copy()
    mapping.to_particles(0.0, 0.0, move=True)
    value, p.velocity[:] = p.velocity.copy(), kept
    return value, velocity_gradient(mapping)


def velocity_gradient(mapping: Mapping) -> np.ndarray:
    """sum_i v_i (x) grad phi_ip (n, 3, 3) of what the nodes hold."""
    result = np.zeros((len(mapping.particles), 3, 3))

    def keep(start: int, stop: int, gradient: np.ndarray) -> int:
        result[start:stop] = gradient[: stop - start]
        return -1

    mapping.to_particles(0.0, 0.0, move=False, deform=keep)
    return result
