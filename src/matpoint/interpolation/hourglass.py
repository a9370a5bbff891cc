"""Hourglass control for zones of enriched domains (methods, section 4)."""

from __future__ import annotations

import numpy as np

from matpoint.interpolation.contract import Setting
from matpoint.kernels.hourglass import hourglass_forces
from matpoint.vertices import Vertices


class HourglassControl:
    """Springs against what no affine map of a domain's initial corners gives.

    A domain has one stress, so a motion of its corners that leaves its mean gradient alone meets no
    resistance. Where all corners are degrees of freedom such motions can grow. The springs act on
    d_a = x_a - x_c - F (X_a - X_c), with F from the corners: zero in any affine motion, so rigid turns
    and uniform strains stay free, and momentum and angular momentum are kept.

    Parameters
    ----------
    vertices, setting
        The mesh of domains, and the particles' stiffness.
    strength
        Spring constant in units of rho c^2 V0^(1 - 2/d); 0.43 is a fully integrated square.
    """

    def __init__(self, vertices: Vertices, setting: Setting, strength: float) -> None:
        v, own = vertices, vertices.is_enriched
        used = np.arange(v.connectivity.shape[1]) < v.count[:, None]
        inside = (own[v.connectivity] | ~used).all(axis=1)
        # Lines and simplices have no such motion.
        chosen = np.flatnonzero(inside & np.isin(v.kind, (1, 2)))
        width = v.connectivity.shape[1]
        self.ids = setting.particles.id[chosen]
        self.corners = np.ascontiguousarray(v.connectivity[chosen])
        weights = v.initial_weights()[chosen]
        X = v.position0[self.corners]
        centre = np.einsum("pc,pca->pa", weights[..., 0], X)
        gap = np.eye(width) - weights[:, None, :, 0]
        gap -= np.einsum("pak,pbk->pab", X - centre[:, None], weights[..., 1:])
        self.matrix = np.einsum("pca,pcb->pab", gap, gap)
        volume = setting.particles.volume0[chosen]
        dim = setting.grid.dim
        self.stiffness = strength * setting.stiffness[chosen] * volume ** (1.0 - 2.0 / dim)

    def act(self, vertices: Vertices, *, push: bool) -> float:
        """Add the springs' forces to the vertices' records, or only return their energy [J]."""
        return float(
            hourglass_forces(
                self.corners, self.stiffness, self.matrix, vertices.position, vertices.flat, push
            )
        )

    def release(self, particle: int) -> None:
        """Drop the springs of a domain that has fallen back to corners of its own."""
        keep = self.ids != particle
        self.ids, self.corners = self.ids[keep], self.corners[keep]
        self.matrix, self.stiffness = self.matrix[keep], self.stiffness[keep]
