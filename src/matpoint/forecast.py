"""How much memory a run will need, known before it is made.

A small block is set up by the same method and materials, and its arrays are measured, so the forecast
can't fall behind what the methods really keep.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from matpoint.body import Body
from matpoint.domains import Domains
from matpoint.errors import InputError
from matpoint.footprint import Forecast, Need, held
from matpoint.grid import Grid
from matpoint.interpolation.contract import Interpolation
from matpoint.interpolation.cpdi import CPDI2
from matpoint.interpolation.enriched import EnrichedCPDI2
from matpoint.loads import Gravity
from matpoint.materials import Material
from matpoint.memory import free_memory
from matpoint.regions import Box, Region
from matpoint.scheme import Scheme
from matpoint.setup import distinct_materials
from matpoint.simulation import Simulation
from matpoint.timestep import CFL

_PROBE = 4096.0  # about how many particles the small block has
_NODE_SETUP = 48.0  # bytes a node that setting up the conditions takes for a while: its position, twice
_LATTICE = 6.0  # bytes that filling takes for a while for each place of the lattice around a region
_SORTING = 20.0  # bytes a particle that sorting takes for a while
_UNSEEN = 40.0  # bytes a particle that the process takes beyond its arrays, measured where domains are kept
_SAMPLE = 32768.0  # points that a region is asked about


class Buffered(Protocol):
    """A writer that says how many bytes it takes for a while to write a simulation."""

    def buffer(self, sim: Simulation) -> int:
        """Return bytes."""
        ...


def forecast(
    grid: Grid,
    bodies: Sequence[Body],
    interpolation: Interpolation,
    scheme: Scheme | None = None,
    writers: Sequence[Buffered] = (),
) -> Forecast:
    """Return the memory that a run of these bodies by a method will need.

    Parameters
    ----------
    grid, bodies, interpolation, scheme
        As for :class:`matpoint.Simulation`.
    writers
        Those that take memory to write; they write one after the other.
    """
    if not bodies:
        raise InputError("simulation: no bodies, so no particles; give at least one")
    materials = sorted(distinct_materials(bodies)[0], key=lambda m: -len(m.state_variables))[:2]
    filled = [body for body in bodies if isinstance(body.geometry, Region)]
    per_cell = _per_cell(filled[0], grid.dim) if filled else (2,) * grid.dim
    sim = _probe(grid.dim, materials, per_cell, interpolation, scheme)
    n, count = len(sim.particles), 0.0
    places = vertices = 0.0
    for body in bodies:
        inside, lattice, shared = _sizes(body, grid)
        count, places, vertices = count + inside, places + lattice, vertices + shared
    each: dict[str, float] = dict.fromkeys(("particles", "domains", "transfers"), 0.0)
    share = 1.0  # vertices a particle, against those of the small block
    corners = sim.engine.mapping.corners
    if 0 < corners < n * 2**grid.dim:
        share = (vertices / count) / (corners / n)
    per_node: dict[str, float] = dict.fromkeys(("records", "transfers"), 0.0)
    nodes = sim.engine.mapping.nodes
    rows, cells = len(nodes.records), math.prod(sim.grid.cells)
    for group, _, array in held(sim):
        if group == "nodes":
            per_node["records"] += array.nbytes / rows
            each["domains"] += (rows - nodes.on_grid) / n * array.nbytes / rows  # enriched vertices
        elif len(array) in (nodes.on_grid, cells, cells + 1):
            per_node["transfers"] += array.nbytes / nodes.on_grid
        else:
            own = group == "domains" and array.shape[0] != n
            each[group] += array.nbytes / n * (share if own else 1.0)
    # Domains, corners and lists, stand twice while bodies are put together, whatever becomes of them.
    shapes = _UNSEEN if each["domains"] > 0 else 2.0 * (24.0 + 4.0 * 2**grid.dim)
    each["set-up, sorting"] = max(_SORTING + shapes, _LATTICE * places / count)
    each["results"] = max((writer.buffer(sim) for writer in writers), default=0.0) / n
    extra = [a - b for a, b in zip(nodes.shape, (*sim.grid.cells, 1, 1), strict=False)]
    total = math.prod(float(cells + more) for cells, more in zip(grid.cells, extra, strict=False))
    return Forecast(
        Need(count, {k: v for k, v in each.items() if v > 0}),
        Need(total, {**{k: v for k, v in per_node.items() if v > 0}, "set-up": _NODE_SETUP}),
        free_memory(),
    )


def _per_cell(body: Body, dim: int) -> tuple[int, ...]:
    count = tuple(body.per_cell) if isinstance(body.per_cell, tuple | list) else (body.per_cell,) * dim
    if len(count) != dim:
        raise InputError(f"{body.label}: per_cell has {len(count)} numbers, the grid {dim} axes")
    return count


def _probe(
    dim: int,
    materials: Sequence[Material],
    per_cell: tuple[int, ...],
    interpolation: Interpolation,
    scheme: Scheme | None,
) -> Simulation:
    """A small block of all materials, side by side, by the same method."""
    if isinstance(interpolation, EnrichedCPDI2) and interpolation.where != "all":
        interpolation = CPDI2(interpolation.on_inversion)  # few vertices are enriched
    m, most = len(materials), int((_PROBE / 2**dim) ** (1.0 / dim))
    per_cell = tuple(min(count, most) for count in per_cell)
    cells = max(2, round((_PROBE / m / math.prod(per_cell)) ** (1.0 / dim)))
    grid = Grid((-2.0,) * dim, (cells * m + 2.0, *(cells + 2.0,) * (dim - 1)), 1.0)
    bodies = [
        Body(Box((float(cells * k), *(0.0,) * (dim - 1)), (cells * (k + 1.0), *(float(cells),) * (dim - 1))),
             material, per_cell)
        for k, material in enumerate(materials)
    ]  # fmt: skip
    sim = Simulation(
        grid, bodies, interpolation=interpolation, scheme=scheme,
        timestep=CFL(0.1, largest=1.0), threads=1, loads=[Gravity((0.0,) * dim)],
    )  # fmt: skip
    sim.advance(sim.dt)  # some arrays are made by the first step
    return sim


def _sizes(body: Body, grid: Grid) -> tuple[float, float, float]:
    """About how many particles a body has, boxes of the lattice around it, and corners."""
    shape = body.geometry
    if isinstance(shape, Domains):
        return float(shape.n), 0.0, float(len(shape.vertices))
    low, high = (np.asarray(b, dtype=float)[: grid.dim] for b in shape.bounds())
    if not (np.isfinite(low).all() and np.isfinite(high).all()):
        raise InputError(f"{body.label}: its region is not bounded, so it can't be filled")
    spacing = np.array(grid.cell) / np.array(_per_cell(body, grid.dim))
    counts = np.maximum((high - low) / spacing, 1.0)
    boxes = float(np.prod(counts))
    samples = np.minimum(np.ceil(counts), round(_SAMPLE ** (1.0 / grid.dim))).astype(int)
    axes = [a + (np.arange(m) + 0.5) * (b - a) / m for a, b, m in zip(low, high, samples, strict=True)]
    points = np.zeros((math.prod(map(len, axes)), 3))
    for k, values in enumerate(np.meshgrid(*axes, indexing="ij")):
        points[:, k] = values.ravel()
    filled = float(np.mean(np.asarray(shape.contains(points), dtype=bool)))
    inside = max(filled * boxes, 1.0)
    return inside, boxes, inside * float(np.prod(1.0 + 1.0 / counts))
