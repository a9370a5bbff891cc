"""First Piola-Kirchhoff stresses P(F) in sympy, of the materials that have one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import sympy as sp

from matpoint.errors import InputError
from matpoint.materials import Hencky, Material, NeoHookean, SaintVenantKirchhoff

#: Takes a material and F, a 3 x 3 matrix of expressions; returns P [Pa].
Law = Callable[[Any, sp.Matrix], sp.Matrix]


def neo_hookean(material: NeoHookean, F: sp.Matrix) -> sp.Matrix:
    """Return P = λ ln J F⁻ᵀ + μ (F - F⁻ᵀ) (S 27; T 42 prints the transpose)."""
    inverse = F.cofactor_matrix() / F.det()
    return material.lame * sp.log(F.det()) * inverse + material.shear * (F - inverse)


def saint_venant_kirchhoff(material: SaintVenantKirchhoff, F: sp.Matrix) -> sp.Matrix:
    """Return P = F S with S = λ tr(E) I + 2μ E and E = (Fᵀ F - I)/2."""
    E = (F.T * F - sp.eye(3)) / 2
    return F * (material.lame * E.trace() * sp.eye(3) + 2 * material.shear * E)


def hencky(material: Hencky, F: sp.Matrix) -> sp.Matrix:
    """Return P_kk = (λ ln J + 2μ ln F_kk)/F_kk, for F along the axes only.

    Raises
    ------
    InputError
        If F is not diagonal: in sympy its logarithm would need its eigenvectors.
    """
    if not F.is_diagonal():
        raise InputError("manufactured solution: Hencky elasticity needs a displacement along the axes")
    logs = [sp.log(F[k, k]) for k in range(3)]
    return sp.diag(*((material.lame * sum(logs) + 2 * material.shear * logs[k]) / F[k, k] for k in range(3)))


#: Class of the material -> its law. Neo-Hookean and Saint Venant-Kirchhoff materials take every F with
#: det F > 0, Hencky's only a diagonal one. Stresses that depend on the path (``VonMises``) or on
#: the rate (``NewtonianFluid``) have no P(F).
LAWS: dict[type[Material], Law] = {
    NeoHookean: neo_hookean,
    SaintVenantKirchhoff: saint_venant_kirchhoff,
    Hencky: hencky,
}


def first_piola(material: Material, F: sp.Matrix) -> sp.Matrix:
    """Return P(F) [Pa] of a material.

    Raises
    ------
    InputError
        If its law is not known in sympy, or can't take such an F.
    """
    law = LAWS.get(type(material))
    if law is None:
        names = ", ".join(kind.__name__ for kind in LAWS)
        raise InputError(
            f"manufactured solution: no P(F) is known of {type(material).__name__}; give one as"
            f" first_piola = function of a sympy matrix, or take {names}"
        )
    return law(material, F)


@dataclass(frozen=True)
class OwnLaw:
    """P(F) [Pa] of a material's own law, as a function of a 3 x 3 sympy matrix.

    Parameters
    ----------
    material
        One of those in ``LAWS``.
    """

    material: Material

    def __call__(self, F: sp.Matrix) -> sp.Matrix:
        """Return P(F)."""
        return first_piola(self.material, F)
