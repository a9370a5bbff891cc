"""The third-order transfers: IMLS at Gauss points, splines as test functions, consistent mass."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from matpoint.errors import MatpointError
from matpoint.interpolation.contract import Held
from matpoint.interpolation.reconstructed import ReconstructedMapping
from matpoint.kernels import consistent as kernels
from matpoint.kernels.box import mass_times
from matpoint.kernels.nodes import clear
from matpoint.kernels.vector import records

_RESIDUAL = 1e-11
_MOST = 200


class _Vectors:
    """Arrays that a solve works on: flat records, and a number a node (see ``kernels.consistent``)."""

    def __init__(self, count: int) -> None:
        self.right, self.u, self.residual, self.direction, self.product = (
            records(count).reshape(-1) for _ in range(5)
        )
        self.inverse, self.lumped = np.zeros(count), np.zeros(count)


class ConsistentMapping(ReconstructedMapping):
    """Velocities are the L2 projection of reconstructed ones; accelerations solve M a = f.

    M_ij = sum_g N_i N_j rho_g w_g is applied point by point and inverted by conjugate gradients, with the
    lumped mass as preconditioner: about 15 products, whatever the grid. Held directions are left out.

    Cut cells, at free surfaces, have fewer particles than functions: a consistent mass of theirs would be
    singular. Their share of the mass is lumped, so that the order drops in these cells only.
    """

    consistent = True

    @cached_property
    def _vectors(self) -> _Vectors:
        return _Vectors(self.nodes.on_grid)

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        self.quadrature.evaluate(self.particles, body)
        self._scatter(kinematic, dynamic)
        if kinematic:
            self._compare()

    def solve(self, dt: float, rate: float, factor: float, held: Held) -> np.ndarray:
        """Turn momenta and forces into velocities and increments; return impulses along what is held."""
        n, v = self.nodes, self._vectors
        seen = n.records[held.index, 3] > 0.0  # others take no part, and stay at rest
        inside = Held(held.index[seen], held.normal[seen], held.before[seen], held.after[seen])
        size = self._sums(
            lambda *some: kernels.begin(*some, n.flat, dt, rate, v.right, v.inverse, v.lumped, v.u)
        )
        self._lump()
        self._conjugate_gradients(inside, size + 1e-300)
        self._each(lambda *some: kernels.take(*some, v.u, n.flat))
        push = np.zeros(len(held.index))
        if len(inside.index):
            self._times(v.u)
            push[seen] = self._reaction(inside)
        return push

    def _reaction(self, held: Held) -> np.ndarray:
        """What M (v+ - v) needs beyond the forces, along the held directions [N s]; ``product`` is M v."""
        v, at = self._vectors, held.index
        lack = v.product.reshape(-1, 8)[at] - v.right.reshape(-1, 8)[at]
        return np.einsum("ca,ca->c", lack[:, 4:7] - lack[:, :3], held.normal)

    def _lump(self) -> None:
        """Split the mass: what the Gauss points give is consistent, the particles of cut cells are lumped."""
        v = self._vectors
        if len(self.quadrature.cut):
            self._each(lambda *some: kernels.fill_ones(*some, v.direction))
            self._times(v.direction)
            self._each(lambda *some: kernels.lump_rest(*some, self.nodes.flat, v.product, v.lumped))

    def _conjugate_gradients(self, held: Held, scale: np.ndarray) -> None:
        """Solve M u = right for u that is given along held directions, from right / m on."""
        v = self._vectors
        self._release(v.u, held)
        for lanes, given in ((slice(0, 3), held.before), (slice(4, 7), held.after)):
            np.add.at(v.u.reshape(-1, 8)[:, lanes], held.index, given[:, None] * held.normal)
        self._times(v.u)
        self._each(lambda *some: kernels.subtract(*some, v.right, v.product, v.residual))
        self._release(v.residual, held)
        self._each(lambda *some: clear(v.direction, *some))
        size, share = self._weigh(), np.zeros(8)
        for _ in range(_MOST):
            if (size <= _RESIDUAL**2 * scale).all():
                return
            self._turn(share)
            self._times(v.direction)
            self._release(v.product, held)
            curvature = self._sums(lambda *some: kernels.multiply(*some, v.direction, v.product))
            self._go(_ratio(size, curvature))
            before, size = size, self._weigh()
            share = _ratio(size, before)
        raise MatpointError("consistent mass: conjugate gradients did not converge; is dt too long?")

    def _turn(self, share: np.ndarray) -> None:
        v = self._vectors
        self._each(lambda *some: kernels.turn(*some, v.inverse, v.residual, share, v.direction))

    def _go(self, step: np.ndarray) -> None:
        v = self._vectors
        self._each(lambda *some: kernels.go(*some, step, v.direction, v.product, v.u, v.residual))

    def _weigh(self) -> np.ndarray:
        v = self._vectors
        return self._sums(lambda *some: kernels.weigh(*some, v.inverse, v.residual))

    @staticmethod
    def _release(vector: np.ndarray, held: Held) -> None:
        """Take the held directions out of two velocities a node."""
        for part in (vector.reshape(-1, 8)[:, :3], vector.reshape(-1, 8)[:, 4:7]):
            along = np.einsum("ca,ca->c", part[held.index], held.normal)
            np.subtract.at(part, held.index, along[:, None] * held.normal)

    def _times(self, source: np.ndarray) -> None:
        """M times a vector, to ``product``."""
        q, n, s, v = self.quadrature, self.nodes, self.quadrature.slabs, self._vectors
        self._each(lambda *some: clear(v.product, *some))
        self.team.coloured(
            s.pointer,
            lambda slabs, a, b: mass_times(
                *n.rows, n.shape[1], n.shape[2], source, v.product, slabs, a, b, s.pointer, s.order,
                q.position, q.mass, len(q.ranks),
            ),
        )  # fmt: skip
        self._each(lambda *some: kernels.add_lumped(*some, v.lumped, v.inverse, source, v.product))

    def _each(self, call: Callable[..., None]) -> None:
        self.nodes.each(self.team, call)

    def _sums(self, call: Callable[..., None]) -> np.ndarray:
        """Sums over the active nodes, one for every lane; planes are added in order."""
        planes = np.zeros((self.nodes.last[0] - self.nodes.first[0], 8))
        flat = planes.reshape(-1)
        self._each(lambda *some: call(*some, flat))
        return planes.sum(axis=0)


def _ratio(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a / b, and 0 where b is not positive: such a lane is solved."""
    return np.divide(a, b, out=np.zeros(len(a)), where=b > 0.0)
