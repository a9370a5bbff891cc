"""How velocities come back to the particles: FLIP, PIC, APIC, XPIC, FMPM.

With S the weights phi_ip that bring nodal velocities to particles, and S+ the transfer from particles to
nodes (m_i^-1 phi_ip m_p, or a reconstruction), the particles' velocities V hold what the nodes do not see:
V - S S+ V, the noise of the null space. FLIP keeps all of it, PIC none, and takes part of S S+ V with it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from matpoint.checks import whole
from matpoint.errors import InputError

_MOST = 100


@dataclass(frozen=True)
class FLIP:
    """Particles take the increment of the nodes' velocity (S 13).

    Parameters
    ----------
    blend
        Share of FLIP; the rest is PIC, which takes the velocity itself and damps.
    """

    blend: float = 1.0
    name: ClassVar[str] = "flip"
    terms: ClassVar[int] = 1
    citation: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        if not (isinstance(self.blend, int | float) and math.isfinite(self.blend) and 0 <= self.blend <= 1):
            raise InputError(f"FLIP: blend = {self.blend!r} must be from 0 (PIC) to 1")

    @property
    def share(self) -> float:
        """FLIP's share of the velocity update."""
        return float(self.blend)


@dataclass(frozen=True)
class PIC:
    """Particles take the nodes' velocity."""

    name: ClassVar[str] = "pic"
    share: ClassVar[float] = 0.0
    terms: ClassVar[int] = 1
    citation: ClassVar[tuple[str, ...]] = ()


@dataclass(frozen=True)
class APIC:
    """PIC with an affine velocity on each particle (Jiang et al. 2015); box family only."""

    name: ClassVar[str] = "apic"
    share: ClassVar[float] = 0.0
    terms: ClassVar[int] = 1
    citation: ClassVar[tuple[str, ...]] = ("jiang2015",)


def _check_order(what: str, order: int) -> None:
    if whole(f"{what}: order", order) > _MOST:
        raise InputError(f"{what}: order = {order!r} must be from 1 (PIC) to {_MOST}")


@dataclass(frozen=True)
class _Series:
    """PIC with ``order`` terms of a series for the velocities."""

    order: int = 2
    share: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        _check_order(type(self).__name__, self.order)

    @property
    def terms(self) -> int:
        """Terms of the series."""
        return self.order


@dataclass(frozen=True)
class XPIC(_Series):
    """PIC whose damping is taken back term by term (Hammerquist and Nairn 2017).

    V+ = S (v* + a dt) with v* = sum_{j < order} (1 - S+ S)^j S+ V, which is V - (1 - S S+)^order V: smooth
    fields are kept to a power of the cell's size that grows with the order, noise of the null space goes in
    each step. The paper's alternating sum of binomials is the same polynomial. Positions and gradients
    take the nodes' velocities v+ = S+ V + a dt, with which forces are work-conjugate; the paper's terms of
    dt^2 in the positions are left out, since velocities here stand half a step before positions.

    Parameters
    ----------
    order
        Number of terms m: 1 is PIC; each further one costs a transfer both ways.
    """

    name: ClassVar[str] = "xpic"
    citation: ClassVar[tuple[str, ...]] = ("hammerquist2017",)


@dataclass(frozen=True)
class FMPM(_Series):
    """PIC with nodal velocities by an approximate inverse of the full mass (Nairn, Hammerquist 2021).

    v(k) = sum_{j < k} (1 - S+ S)^j v+, for S+ S = M_L^-1 M with the full mass M_ij = sum_p phi_ip phi_jp m_p
    and the lumped M_L: the first k terms of Neumann's series of M^-1 p+. Velocities, positions and gradients
    of the particles all take v(k). The frequencies of the grid grow by no more than sqrt(k), and so the
    limit of the step falls.

    Parameters
    ----------
    order
        Number of terms k: 1 is PIC; each further one costs a transfer both ways.
    """

    name: ClassVar[str] = "fmpm"
    citation: ClassVar[tuple[str, ...]] = ("nairn2021",)


Transfer = FLIP | PIC | APIC | XPIC | FMPM

#: Transfer name -> class.
TRANSFERS: dict[str, type[Transfer]] = {t.name: t for t in (FLIP, PIC, APIC, XPIC, FMPM)}
