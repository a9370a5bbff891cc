"""The two-layer bar by explicit finite elements with lumped mass and finite strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from matpoint.errors import InputError
from matpoint.reference.bar import LayeredBar


@dataclass(frozen=True, eq=False)
class BarHistory:
    """What a finite-element run of the bar leaves.

    Attributes
    ----------
    times : ndarray, shape (t,)
        [s]
    nodes : ndarray, shape (n + 1,)
        Initial positions [m], from the free end.
    displacement : ndarray, shape (t, n + 1)
        Of the nodes [m].
    stress : ndarray, shape (t, n)
        Axial Cauchy stress of the elements [Pa].
    """

    times: np.ndarray
    nodes: np.ndarray
    displacement: np.ndarray
    stress: np.ndarray

    @property
    def centres(self) -> np.ndarray:
        """Initial centres of the elements [m], shape (n,)."""
        return 0.5 * (self.nodes[1:] + self.nodes[:-1])

    def at(self, X: float) -> np.ndarray:
        """Return the displacement [m] of the material point X [m] at every time, shape (t,)."""
        e = int(np.clip(np.searchsorted(self.nodes, X) - 1, 0, len(self.nodes) - 2))
        share = (X - self.nodes[e]) / (self.nodes[e + 1] - self.nodes[e])
        return (1 - share) * self.displacement[:, e] + share * self.displacement[:, e + 1]

    def profile(self, time: float) -> np.ndarray:
        """Return the stresses of the elements [Pa] at the sample nearest to a time [s]."""
        return self.stress[int(np.argmin(np.abs(self.times - time)))]


def assemble_bar(bar: LayeredBar, elements: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return nodes, lumped masses and the gradient operator of linear elements.

    Parameters
    ----------
    bar
        The bar.
    elements
        How many; the interface must fall between two of them.

    Returns
    -------
    nodes : ndarray, shape (n + 1,)
        Positions [m].
    mass : ndarray, shape (n + 1,)
        Row sums of the consistent mass [kg].
    gradient : ndarray, shape (n, n + 1)
        G_ea, the integral of dN_a/dX over element e.

    Raises
    ------
    InputError
        If an element would hold both materials.
    """
    from skfem import Basis, BilinearForm, ElementLineP0, ElementLineP1, LinearForm, MeshLine  # noqa: PLC0415

    position = bar.interface / bar.length * elements
    if elements < 2 or abs(position - round(position)) > 1e-9:
        raise InputError(f"bar: {elements} elements don't meet the interface at {bar.interface:g} m")
    mesh = MeshLine(np.linspace(0.0, bar.length, elements + 1))
    linear = Basis(mesh, ElementLineP1())
    constant = linear.with_element(ElementLineP0())
    mass = LinearForm(lambda v, w: bar.density * v).assemble(linear)
    gradient = BilinearForm(lambda u, v, w: u.grad[0] * v).assemble(linear, constant)
    order, rows = np.argsort(linear.doflocs[0]), np.argsort(constant.doflocs[0])
    return linear.doflocs[0][order], mass[order], gradient.toarray()[np.ix_(rows, order)]


def fem_bar(bar: LayeredBar, *, end: float, step: float, elements: int = 18, every: int = 10) -> BarHistory:
    """Run the bar by the finite elements that an explicit particle run is measured against.

    The step is that of the particle methods (symplectic Euler, stress last): f = M g - G^T P,
    v += f/M dt, u += v dt, F = 1 + G u/l, and S 27 in uniaxial strain,
    sigma = lambda ln(J)/J + mu/J (F^2 - 1). With J = F, the first Piola-Kirchhoff stress P is sigma.

    Parameters
    ----------
    bar
        The bar.
    end, step
        End time and time step [s].
    elements
        How many, linear and equal.
    every
        Steps between two samples; the state before the first step is sampled too.

    Raises
    ------
    InputError
        If the step is over the stability limit l/c, or the end is not after the start.
    """
    nodes, mass, G = assemble_bar(bar, elements)
    lengths = np.diff(nodes)
    centres = 0.5 * (nodes[1:] + nodes[:-1])
    limit = float((lengths / bar.wave_speed(centres)).min())
    if not 0 < step <= limit:
        raise InputError(f"bar: step = {step:.4g} s must be positive and at most {limit:.4g} s")
    steps = round(end / step)
    if steps < 1 or every < 1:
        raise InputError(f"bar: end = {end:g} s and every = {every} must allow for one step at least")
    lam, mu = bar.lame(centres)
    weight, B, GT = mass * bar.gravity, G / lengths[:, None], np.ascontiguousarray(G.T)
    free = np.arange(len(nodes)) < len(nodes) - 1  # the last node is the fixed end
    factor = np.where(free, step / mass, 0.0)
    u, v, stress = np.zeros(len(nodes)), np.zeros(len(nodes)), np.zeros(elements)
    times, displacements, stresses = [0.0], [u.copy()], [stress]
    for n in range(1, steps + 1):
        v += factor * (weight - GT @ stress)
        u += step * v
        F = 1.0 + B @ u
        stress = (lam * np.log(F) + mu * (F * F - 1.0)) / F
        if n % every == 0:
            times.append(n * step)
            displacements.append(u.copy())
            stresses.append(stress)
    return BarHistory(np.array(times), nodes, np.array(displacements), np.array(stresses))
