"""Stress fields of inclusion problems against an exact one: norms, orders, and finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from matpoint.domains import Domains

_DOUBLE = np.array([1.0, 1.0, 1.0, 2.0, 2.0, 2.0])  # shears stand twice in a tensor


class Exact(Protocol):
    """A reference solution."""

    def displacement(self, x: np.ndarray) -> np.ndarray:
        """Displacements [m] at points."""
        ...

    def stress(self, x: np.ndarray) -> np.ndarray:
        """Stresses [Pa] at points, shape (..., 6)."""
        ...


@dataclass(frozen=True, eq=False)
class Field:
    """Stresses of one run at rest, by a particle method or by finite elements.

    Attributes
    ----------
    stress, exact : ndarray, shape (n, 6)
        [Pa], of the domains and of the reference at their centroids.
    corners : ndarray, shape (n, K, 3)
        Initial corners of the domains [m].
    volume : ndarray, shape (n,)
        [m^3]
    body : ndarray, shape (n,)
        0 inside, counted outward.
    touching : ndarray of bool, shape (n,)
        Whether a domain has a corner on an interface.
    """

    stress: np.ndarray
    exact: np.ndarray
    corners: np.ndarray
    volume: np.ndarray
    body: np.ndarray
    touching: np.ndarray

    def measure(self) -> dict[str, float]:
        """Return the norms ``inside``, ``largest``, ``outside``."""
        error, size = (((s**2) @ _DOUBLE) ** 0.5 for s in (self.stress - self.exact, self.exact))
        inside, v = self.body == 0, self.volume

        def mean(values: np.ndarray, chosen: np.ndarray) -> float:
            return float(np.sqrt(v[chosen] @ values[chosen] ** 2 / v[chosen].sum()))

        return {
            "inside": mean(error, inside) / mean(size, inside),
            "largest": float(error[self.touching].max()) / mean(size, inside),
            "outside": mean(error, ~inside) / mean(size, ~inside),
        }


def make_field(
    exact: Exact,
    stress: np.ndarray,
    vertices: np.ndarray,
    cells: np.ndarray,
    body: np.ndarray,
    volume: np.ndarray,
    centres: np.ndarray,
) -> Field:
    """Return the field of stresses (n, 6) [Pa] on domains with initial centroids (n, 3) [m]."""
    from matpoint.interpolation.enriched import interface_vertices  # noqa: PLC0415 (keeps imports light)

    on = interface_vertices(cells, body, len(vertices))
    touching = np.asarray(on[cells].any(axis=1))
    return Field(stress, exact.stress(centres), vertices[cells], volume, body, touching)


def elements(parts: Sequence[Domains], youngs: Sequence[float], poisson: float, exact: Exact) -> Field:
    """Return the field of static finite elements, one for each domain.

    The faces of the set ``outer`` take the exact displacement; the planes of symmetry are x = 0 and so on.
    """
    from matpoint.assembly import merge  # noqa: PLC0415 (loaded when used)
    from matpoint.domains import Kind  # noqa: PLC0415
    from matpoint.reference.prescribed import Prescribed  # noqa: PLC0415
    from matpoint.reference.solid import Solid  # noqa: PLC0415
    from matpoint.reference.static import solve_static  # noqa: PLC0415

    mesh = merge(parts, [str(k) for k in range(len(parts))])
    young = np.array(youngs)[mesh.body]
    lame, shear = young * poisson / ((1 + poisson) * (1 - 2 * poisson)), young / (2 * (1 + poisson))
    solid = Solid(mesh.vertices, mesh.cells, Kind(mesh.kind[0]).name.lower(), lame, shear, 1.0)
    x = mesh.vertices
    far = np.unique(np.concatenate([f.corners.ravel() for f in mesh.facets if f.name == "outer"]))
    u = exact.displacement(x[far])
    held = [Prescribed(np.flatnonzero(np.abs(x[:, k]) < 1e-9), k) for k in range(solid.dim)]
    held += [Prescribed(far, k, lambda X, share, k=k: share * u[:, k]) for k in range(solid.dim)]
    stress = solve_static(solid, prescribed=held).stress
    centres = np.concatenate([d.centroids() for d in parts])
    return make_field(exact, stress, x, mesh.cells, mesh.body, solid.volumes, centres)


def fitted_order(divisions: Sequence[int], errors: Sequence[float]) -> float:
    """Return the slope of the line through the errors over the domains' size, both logarithmic."""
    if len(errors) < 2:
        return float("nan")
    return -float(np.polyfit(np.log(divisions), np.log(errors), 1)[0])
