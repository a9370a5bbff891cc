"""How many bytes each stage must move for one particle, and how much it must compute.

Counted is compulsory traffic: every array that a stage reads or writes passes once through memory; records
of nodes and vertices, which neighbours in memory share, stay in cache while they are needed. The read that a
write may cause first is not counted, as in the triad. What a stage takes beyond bytes / bandwidth is
computing. Change the tables below with the kernels that they describe (``kernels/``).
"""

from __future__ import annotations

from matpoint.bench.block import PER_CELL

_RETURN = "nodes to particles and stress"

Traffic = tuple[tuple[str, ...], tuple[str, ...]]  # arrays read, arrays written

# Bytes per particle of the arrays over particles.
_FIELDS: dict[str, float] = {
    "position": 24, "velocity": 24, "mass": 8, "volume": 8, "volume0": 8, "stress": 48, "F": 72,
    "half": 24, "half0": 24, "edges": 72, "edges0": 72, "index": 4, "first": 1,
}  # fmt: skip

# kernels/locate.py: a look at the bounds on the way to a counting sort by slab of "index" (slab, order).
_LOCATE: Traffic = (("position", "index"), ("index", "index"))
_NODES: dict[str, Traffic] = {"clear": ((), ("node",)), "solve": (("node",), ("node",))}
# kernels/stress.py; velocity gradients stay in cache
_STRESS: Traffic = (("index", "F", "volume0"), ("F", "volume", "stress"))
# kernels/ledger.py: the work of loads, booked where positions are known: on the way back, CPDI2's in advance
_BOOK = ("mass", "position", "position")

# kernels/box.py
_POINTS: dict[str, Traffic] = {
    "locate": _LOCATE,
    **_NODES,
    "particles to nodes": (("index", "position", "velocity", "mass", "volume", "stress", "node"), ("node",)),
    _RETURN: (("position", "velocity", "mass", "node", *_STRESS[0]), ("velocity", "position", *_STRESS[1])),
}
# The same with half-lengths that follow F (cpGIMP, kernels/stretch.py); boxes of one size share theirs.
_BOXES: dict[str, Traffic] = {
    **_POINTS,
    "particles to nodes": ((*_POINTS["particles to nodes"][0], "half"), ("node",)),
}
_BOXES[_RETURN] = ((*_POINTS[_RETURN][0], "half"), _POINTS[_RETURN][1])
_STRETCHED: dict[str, Traffic] = {**_BOXES, "advance": (("F", "half0"), ("half",))}
# kernels/parallelepiped.py: corners are made of positions and half edges, r_k = F r_k0.
_PARALLELEPIPEDS: dict[str, Traffic] = {
    **_POINTS,
    "particles to nodes": ((*_POINTS["particles to nodes"][0], "edges"), ("node",)),
    _RETURN: ((*_POINTS[_RETURN][0], "edges"), _POINTS[_RETURN][1]),
    "advance": (("F", "edges0"), ("edges",)),
}
# kernels/vertex.py: "weights" are R and G of all corners, "first" tells who adds to a record first.
_TO_VERTICES = ("connectivity", "first", "weights", "velocity", "mass", "volume", "stress")
_SHARED: dict[str, Traffic] = {
    "locate": (("corners", "slab"), ("slab", "slab")),
    **_NODES,
    "particles to nodes": (
        (*_TO_VERTICES, "slab", "corners", "records", "node"),
        ("records", "node"),
    ),
    _RETURN: (
        ("slab", "corners", "node", "connectivity", "weights", "records", "velocity", *_STRESS[0]),
        ("records", "corners", "velocity", *_STRESS[1]),
    ),
    "advance": ((*_BOOK, "connectivity", "corners"), ("weights", "position")),
}

#: Row -> its table. The reconstructions have none: they compute, and memory hardly matters.
TABLES: dict[str, dict[str, Traffic]] = {
    "linear": _POINTS, "bspline2": _POINTS, "bspline3": _POINTS, "ugimp": _BOXES, "cpgimp": _STRETCHED,
    "cpdi1": _PARALLELEPIPEDS, "cpdi2": _SHARED, "enriched-cpdi2": _SHARED,
}  # fmt: skip


def sizes(name: str, dim: int) -> dict[str, float]:
    """Return the bytes per particle of every array that the tables name."""
    corners = 2**dim
    nodes = 1.0 / PER_CELL[dim] ** dim
    return _FIELDS | {
        "node": 64.0 * nodes,
        # A vertex is shared by as many domains as a domain has corners.
        "corners": 24.0, "records": 64.0, "slab": 4.0,
        "connectivity": 4.0 * corners, "weights": 32.0 * corners,
    }  # fmt: skip


def bytes_per_stage(name: str, dim: int) -> dict[str, float]:
    """Return the bytes per particle that each stage moves; empty for rows without a model."""
    size = sizes(name, dim)
    return {
        stage: sum(size[array] for array in (*read, *written))
        for stage, (read, written) in TABLES.get(name, {}).items()
    }


# Nodes along an axis that see a point; the vertex family's are those of a corner.
_REACH = {"linear": 2, "ugimp": 3, "cpgimp": 3, "bspline2": 3, "bspline3": 4}
_LANES = 8
_STRESS_OPERATIONS = 100  # kernels/stress.py: (I + L dt) F 36, det 10, F F^T 18, the rest 16, ln about 20


_HEXAHEDRON = 185  # kernels/corners.py: lane operations for R, G and the centroid of one domain


def operations_per_stage(name: str, dim: int) -> dict[str, float]:
    """Return the multiply-adds in float64 per particle of the transfers, the stress and hexahedra's weights.

    A step over a record of eight lanes counts as eight, idle lanes included: they take the same time. Rows of
    weights are left out, and so are the corner weights of other domains.
    """
    if name not in TABLES:
        return {}
    corners, reach = 2**dim, _REACH.get(name, 2)
    lines, nodes = reach**2, reach**dim  # a missing third axis has one node
    if name in _REACH:  # kernels/box.py: four steps for each plane, three for each line, two for each node
        each_way = float(_LANES * (4 * reach + 3 * lines + 2 * nodes))
        return {"particles to nodes": each_way, _RETURN: each_way + _STRESS_OPERATIONS}
    vertices = corners if name == "cpdi1" else 1
    # Between a corner and its cell, and four steps between a corner and its particle.
    each_way = float(_LANES * (vertices * (lines + nodes) + 4 * corners))
    weights = {"advance": float(_LANES * _HEXAHEDRON)} if dim == 3 and name != "cpdi1" else {}
    return {"particles to nodes": each_way, _RETURN: each_way + _STRESS_OPERATIONS, **weights}
