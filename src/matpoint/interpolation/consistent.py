"""The third-order transfers: IMLS at Gauss points, splines as test functions, consistent mass."""

from __future__ import annotations

import numpy as np

from matpoint.errors import MatpointError
from matpoint.interpolation.contract import Held
from matpoint.interpolation.reconstructed import ReconstructedMapping
from matpoint.kernels.box import mass_times
from matpoint.kernels.vector import records

_LANES = (0, 1, 2, 4, 5, 6)  # of a record: velocity at the start of the step, and at its end
_RESIDUAL = 1e-11
_MOST = 200


class ConsistentMapping(ReconstructedMapping):
    """Velocities are the L2 projection of reconstructed ones; accelerations solve M a = f.

    M_ij = sum_g N_i N_j rho_g w_g is applied point by point and inverted by conjugate gradients, with the
    lumped mass as preconditioner: about 15 products, whatever the grid. Held directions are left out.

    Cut cells, at free surfaces, have fewer particles than functions: a consistent mass of theirs would be
    singular. Their share of the mass is lumped, so that the order drops in these cells only.
    """

    consistent = True

    def to_nodes(self, body: np.ndarray, *, kinematic: bool, dynamic: bool) -> None:
        self.quadrature.evaluate(self.particles, body, with_velocity=True)
        self._scatter(kinematic, dynamic)
        if kinematic:
            self._compare_momenta()

    def solve(self, dt: float, rate: float, factor: float, held: Held) -> np.ndarray:
        """Turn momenta and forces into velocities and increments; return impulses along what is held."""
        n = self.nodes.records
        start, force = n[:, :3].copy(), n[:, 4:7] - rate * n[:, :3]
        mass = n[:, 3].copy()
        seen = mass > 0.0
        self._lump(mass)
        right = np.zeros((len(n), 6))
        right[:, :3], right[:, 3:] = start, start + dt * force
        given = np.zeros_like(right)
        np.add.at(given[:, :3], held.index, held.before[:, None] * held.normal)
        np.add.at(given[:, 3:], held.index, held.after[:, None] * held.normal)
        velocity = self._conjugate_gradients(right, given, mass, seen, held)
        n[:, :3] = velocity[:, 3:]
        n[:, 4:7] = velocity[:, 3:] - velocity[:, :3]
        if len(held.index) == 0:
            return np.zeros(0)
        change = self._times(velocity)
        reaction = (change[:, 3:] - change[:, :3]) - dt * force
        return np.einsum("ca,ca->c", reaction[held.index], held.normal)

    def _lump(self, mass: np.ndarray) -> None:
        """Split the mass: what the Gauss points give is consistent, the particles of cut cells are lumped."""
        q = self.quadrature
        gauss = len(q.ranks)
        self._points = np.where(np.arange(len(q.mass)) < gauss, q.mass, 0.0)
        self._lumped = np.zeros((len(mass), 1))
        if len(q.cut):
            ones = np.ones((len(mass), 6))
            self._lumped = np.maximum(mass - self._times(ones)[:, 0], 0.0)[:, None]

    def _conjugate_gradients(
        self, right: np.ndarray, given: np.ndarray, mass: np.ndarray, seen: np.ndarray, held: Held
    ) -> np.ndarray:
        """Solve M u = right for u = given along held directions, six columns at a time."""
        inverse = np.divide(1.0, mass, out=np.zeros_like(mass), where=seen)[:, None]
        free = inverse * right
        self._release(free, held)
        u = free + given
        residual = right - self._times(u)
        self._release(residual, held)
        residual[~seen] = 0.0
        scale = np.einsum("na,na->a", right, inverse * right) + 1e-300
        z = inverse * residual
        direction, size = z.copy(), np.einsum("na,na->a", residual, z)
        for _ in range(_MOST):
            if (size <= _RESIDUAL**2 * scale).all():
                return u
            image = self._times(direction)
            self._release(image, held)
            image[~seen] = 0.0
            curvature = np.einsum("na,na->a", direction, image)
            step = np.divide(size, curvature, out=np.zeros(6), where=curvature > 0.0)
            u += step * direction
            residual -= step * image
            z = inverse * residual
            before, size = size, np.einsum("na,na->a", residual, z)
            direction = z + np.divide(size, before, out=np.zeros(6), where=before > 0.0) * direction
        raise MatpointError("consistent mass: conjugate gradients did not converge; is dt too long?")

    @staticmethod
    def _release(values: np.ndarray, held: Held) -> None:
        """Take the held directions out of two vectors a node, shape (nodes, 6)."""
        for part in (values[:, :3], values[:, 3:]):
            along = np.einsum("ca,ca->c", part[held.index], held.normal)
            np.subtract.at(part, held.index, along[:, None] * held.normal)

    def _times(self, values: np.ndarray) -> np.ndarray:
        """M times two vectors a node, shape (nodes, 6)."""
        source, target = records(len(values)), records(len(values))
        source[:, _LANES] = values
        q, n = self.quadrature, self.nodes
        s = q.slabs
        flat, result = source.reshape(-1), target.reshape(-1)
        self.team.coloured(
            s.pointer,
            lambda slabs, a, b: mass_times(
                *n.rows, n.shape[1], n.shape[2], flat, result, slabs, a, b, s.pointer, s.order, q.position,
                self._points,
            ),
        )  # fmt: skip
        return target[:, _LANES] + self._lumped * values
