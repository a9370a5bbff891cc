"""Results over time in one VTKHDF file, which ParaView opens with its time slider.

The format is VTK's own (docs.vtk.org, "VTKHDF file format", version 2.2): an unstructured grid with
a ``Steps`` group of offsets. Points and fields are appended at each step; topology is written once,
and again only if domains have changed their corners (those that fell back to CPDI1).
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from matpoint.domains import Kind
from matpoint.errors import InputError
from matpoint.output.folder import claim
from matpoint.output.staged import staged_hdf5
from matpoint.output.triggers import Trigger
from matpoint.quality import aspect_ratios, corner_jacobians
from matpoint.quantities import domain_gaps

if TYPE_CHECKING:
    from matpoint.simulation import Simulation
    from matpoint.vertices import Vertices

_VTK_VERTEX = 1
_VTK_CELL = {Kind.LINE: 3, Kind.QUAD: 9, Kind.HEX: 12, Kind.TRI: 5, Kind.TET: 10}
_CHUNK = 1 << 14  # rows per chunk


def _fields(sim: Simulation) -> dict[str, np.ndarray]:
    """Particle fields in order of id."""
    p = sim.particles
    names = ("material", "body", "velocity", "stress", "volume")
    fields = {"id": np.arange(len(p))} | {name: p.ordered(name) for name in names}
    fields["displacement"] = p.ordered("position") - p.ordered("position0")
    fields["deformation_gradient"] = p.ordered("deformation_gradient").reshape(-1, 9)
    state = p.ordered("state")
    for k, name in enumerate(_state_names(sim)):
        fields[f"state.{name}"] = state[:, k]
    return fields


def _domain_fields(sim: Simulation, vertices: Vertices) -> dict[str, np.ndarray]:
    """The shape of each domain, in order of id."""
    order = np.argsort(sim.particles.id)
    fallen = np.zeros(len(sim.particles), dtype=np.uint8)
    fallen[sim.fallen] = 1
    return {
        "fallen": fallen,
        "corner_jacobian": corner_jacobians(vertices)[order],
        "aspect_ratio": aspect_ratios(vertices)[order],
        "domain_gap": domain_gaps(sim)[order],
    }


def _reconstruction_fields(sim: Simulation) -> dict[str, np.ndarray]:
    """Rank and condition number in each particle's cell, in order of id, for methods that reconstruct."""
    mapping: Any = sim.engine.mapping
    if not hasattr(mapping, "by_cell"):
        return {}
    q, order = mapping.quadrature, np.argsort(sim.particles.id)
    if sim.step == 0:  # nothing has been reconstructed yet
        nothing = np.zeros(len(order))
        return {"rank": nothing, "condition": nothing}
    rank = mapping.by_cell(q.ranks, np.minimum)
    condition = mapping.by_cell(np.minimum(q.conditions, 1e300), np.maximum)
    return {"rank": rank[order], "condition": condition[order]}


def _state_names(sim: Simulation) -> list[str]:
    """Names of state variables, if all materials that have any agree on them."""
    sets = {tuple(m.state_variables) for m in sim.materials if m.state_variables}
    return list(sets.pop()) if len(sets) == 1 else []


class VTKHDF:
    """A time series of particles: points for the box family, deformed cells for the vertex family.

    The file is closed after every step, so that what has been written stays readable however the run
    ends, a full disk included. Particles stand in order of id.

    Parameters
    ----------
    path
        The file; the ending ``.vtkhdf`` makes ParaView recognise it.
    trigger
        When a step is written.
    """

    def __init__(self, path: Path, trigger: Trigger) -> None:
        self.path, self.trigger, self.files = path, trigger, (path.name,)

    def open(self, sim: Simulation) -> None:
        """Create the file, still without steps."""
        self._connectivity = np.zeros(0, dtype=np.int64)
        self._block = {"PartOffsets": -1, "CellOffsets": 0, "ConnectivityIdOffsets": 0}
        try:
            with staged_hdf5(claim(self.path), "w") as file:
                root = file.create_group("VTKHDF")
                root.attrs["Version"] = np.array([2, 2])
                root.attrs.create("Type", np.bytes_("UnstructuredGrid"))
                root.create_group("PointData")
                root.create_group("CellData")
                steps = root.create_group("Steps")
                steps.attrs["NSteps"] = 0
                for group in ("PointDataOffsets", "CellDataOffsets"):
                    steps.create_group(group)
        except OSError as error:
            raise InputError(f"vtk: {self.path} can't be written ({error.strerror or error})") from None

    def write(self, sim: Simulation) -> None:
        """Append the present state: data first, then the number of steps that counts it."""
        particles, cells = _fields(sim), {}
        if sim.vertices is None:
            points, point_data = sim.particles.ordered("position"), particles | _reconstruction_fields(sim)
        else:
            v = sim.vertices
            points, cells = v.position, particles | _domain_fields(sim, v)
            point_data = {
                "displacement": v.position - v.position0,
                "enriched": v.is_enriched.astype(np.uint8),
            }
        with staged_hdf5(self.path, "r+") as file:
            root = file["VTKHDF"]
            steps = root["Steps"]
            number = int(steps.attrs["NSteps"])
            self._write_topology(root, sim, len(points))
            row = {**self._block, "NumberOfParts": 1, "PointOffsets": self._length(root, "Points")}
            self._append(root, "Points", points)
            for group, data in (("PointData", point_data), ("CellData", cells)):
                for name, values in data.items():
                    offset = np.array([self._length(root[group], name)])
                    self._append(root[group], name, values)
                    self._append(steps[f"{group}Offsets"], name, offset)
            for name, value in row.items():
                shape = (1, 1) if name in ("CellOffsets", "ConnectivityIdOffsets") else (1,)
                self._append(steps, name, np.full(shape, value))
            self._append(steps, "Values", np.array([sim.time]))
            steps.attrs["NSteps"] = number + 1

    def _write_topology(self, root: Any, sim: Simulation, points: int) -> None:
        """Append connectivity, offsets and types as a new part if they are not those written last."""
        connectivity, offsets, types = self._topology(sim)
        if np.array_equal(connectivity, self._connectivity):
            return
        self._connectivity = connectivity
        self._block = {
            "PartOffsets": self._block["PartOffsets"] + 1,
            "CellOffsets": self._length(root, "Types"),
            "ConnectivityIdOffsets": self._length(root, "Connectivity"),
        }
        for name, values in (("Connectivity", connectivity), ("Offsets", offsets), ("Types", types)):
            self._append(root, name, values)
        for name, count in (
            ("NumberOfPoints", points),
            ("NumberOfCells", len(types)),
            ("NumberOfConnectivityIds", len(connectivity)),
        ):
            self._append(root, name, np.array([count]))

    def close(self, sim: Simulation, error: BaseException | None) -> None:
        """Nothing is left open between steps."""

    def buffer(self, sim: Simulation) -> int:
        """Return the bytes that writing takes: fields, topology, and the file until it is whole."""
        fields, v, made = _fields(sim), sim.vertices, 0
        if v is not None:
            fields |= _domain_fields(sim, v)
            made = 0 if len(v.records) else 2 * v.position.nbytes + v.connectivity.nbytes  # CPDI1's
        return 2 * sum(a.nbytes for a in (*fields.values(), *self._topology(sim))) + made

    # -- helpers -----------------------------------------------------------------------------

    @staticmethod
    def _append(group: Any, name: str, values: np.ndarray) -> None:
        """Add rows to a dataset that grows, making it if it is not there."""
        values = np.asarray(values)
        if name not in group:
            rows = max(1, min(_CHUNK, len(values) or _CHUNK))
            group.create_dataset(
                name,
                shape=(0, *values.shape[1:]),
                maxshape=(None, *values.shape[1:]),
                chunks=(rows, *values.shape[1:]),
                dtype=values.dtype,
                compression="gzip",
                compression_opts=1,
            )
        data = group[name]
        start = len(data)
        data.resize(start + len(values), axis=0)
        data[start:] = values

    @staticmethod
    def _length(group: Any, name: str) -> int:
        return len(group[name]) if name in group else 0

    @staticmethod
    def _topology(sim: Simulation) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Connectivity, offsets and cell types, in order of id."""
        n, v = len(sim.particles), sim.vertices
        if v is None:
            return np.arange(n), np.arange(n + 1), np.full(n, _VTK_VERTEX, dtype=np.uint8)
        order = np.argsort(sim.particles.id)
        rows, count = v.connectivity[order], v.count[order]
        used = np.arange(rows.shape[1]) < count[:, None]
        types = np.array([_VTK_CELL[Kind(k)] for k in range(len(Kind))], dtype=np.uint8)[v.kind[order]]
        return rows[used].astype(np.int64), np.concatenate([[0], np.cumsum(count)]), types
