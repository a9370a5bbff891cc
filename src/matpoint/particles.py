"""Particles: the state of the material, a structure of arrays."""

from __future__ import annotations

import numpy as np

from matpoint.kernels.order import reorder
from matpoint.threads import Team

#: Some particles: a slice, or their internal indices.
Rows = slice | np.ndarray
#: The largest number of bodies that a particle can tell apart.
MOST = 32767

_REQUIRED: dict[str, tuple[int, ...]] = {
    "position": (3,),
    "position0": (3,),
    "velocity": (3,),
    "mass": (),
    "volume": (),
    "volume0": (),
    "deformation_gradient": (3, 3),
    "stress": (6,),
}


class Particles:
    """Arrays over the particles, in an internal order that sorting by cell may change.

    ``id`` numbers the particles in the order in which the bodies were given; it never changes.
    Use :meth:`ordered` to read a field by id.

    Attributes
    ----------
    id : ndarray of int32, shape (n,)
    material, body : ndarray of int16, shape (n,)
        Index of the material and of the body.
    position, position0, velocity : ndarray, shape (n, 3)
        Current and initial position [m], velocity [m/s].
    mass, volume, volume0 : ndarray, shape (n,)
        Mass [kg], current and initial volume [m^3] (unit thickness on missing axes).
    deformation_gradient : ndarray, shape (n, 3, 3)
        F [-]. (The velocity gradient is used as it comes and not kept.)
    stress : ndarray, shape (n, 6)
        Cauchy stress [Pa], order xx, yy, zz, xy, yz, xz.
    state : ndarray, shape (n, s)
        State variables of the materials; s is the largest number that any of them has.
    affine_moment : ndarray, shape (n, 3, 3)
        APIC's B = sum w v (x_i - x_p)^T [m^2/s], in runs with APIC only.
    """

    id: np.ndarray
    material: np.ndarray
    body: np.ndarray
    position: np.ndarray
    position0: np.ndarray
    velocity: np.ndarray
    mass: np.ndarray
    volume: np.ndarray
    volume0: np.ndarray
    deformation_gradient: np.ndarray
    stress: np.ndarray
    state: np.ndarray
    affine_moment: np.ndarray

    def __init__(self, count: int, state_variables: int = 0) -> None:
        self._names: list[str] = ["id", "material", "body", "state", *_REQUIRED]
        self.id = np.arange(count, dtype=np.int32)
        self.material = np.zeros(count, dtype=np.int16)
        self.body = np.zeros(count, dtype=np.int16)
        self.state = np.zeros((count, state_variables))
        for name, shape in _REQUIRED.items():
            setattr(self, name, np.zeros((count, *shape)))
        self.deformation_gradient[:] = np.eye(3)

    def __len__(self) -> int:
        return len(self.id)

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of all arrays, those that the interpolation asked for included."""
        return tuple(self._names)

    def add(self, name: str, values: np.ndarray) -> None:
        """Carry one more array over the particles, sorted with the others."""
        setattr(self, name, np.ascontiguousarray(values))
        if name not in self._names:
            self._names.append(name)

    def ordered(self, name: str) -> np.ndarray:
        """Return a copy of a field in order of id."""
        values = getattr(self, name)
        result = np.empty_like(values)
        result[self.id] = values
        return result

    def permute(self, order: np.ndarray, team: Team) -> None:
        """Put all arrays in a new order, in place: entry k becomes what entry order[k] was."""

        def some(_: int, start: int, stop: int) -> None:
            done = np.zeros(len(self), dtype=bool)
            for name in self._names[start:stop]:
                self._permute(name, order, done)

        team.map(some, [(k, k + 1) for k in range(len(self._names))])

    def _permute(self, name: str, order: np.ndarray, done: np.ndarray) -> None:
        values = getattr(self, name)
        rows = values.reshape(len(self), -1)
        if rows.nbytes > 8 * len(self):  # without a second array
            rows = rows.view(np.uint8)
            reorder(order, rows, done, np.empty(rows.shape[1], dtype=np.uint8))
        else:
            values[:] = values[order]
