"""A cantilever under a dead tip load at any deflection: the inextensible elastica.

E I theta'' = -P cos(theta), theta(0) = 0, theta'(L) = 0, with theta the rotation from the straight bar.
With 1 + sin(theta) = 2 k^2 sin^2(phi), phi runs from phi_0, sin(phi_0) = 1/(k sqrt 2), to pi/2, and
s sqrt(P/(E I)) = F(phi, k) - F(phi_0, k) (Bisshopp and Drucker 1945).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from matpoint.errors import InputError


@dataclass(frozen=True)
class Elastica:
    """A slender bar along x, clamped at its start, with a force across it at the tip.

    Parameters
    ----------
    length
        [m]
    stiffness
        Of bending, E I [N m^2]; per thickness, E/(1 - nu^2) t^3/12 [N m], in plane strain.
    load
        Dead force P at the tip, across the straight bar [N]; the bar deflects to its side.

    Raises
    ------
    InputError
        If a parameter is not a positive number, or P L^2/(E I) is over 100 (where the bar is
        straight along the load but for a bend at the clamp).
    """

    length: float
    stiffness: float
    load: float

    def __post_init__(self) -> None:
        for name in ("length", "stiffness", "load"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                raise InputError(f"elastica: {name} = {value!r} must be a positive number")
        if not self.number <= 100:
            raise InputError(f"elastica: P L^2/(E I) = {self.number:g} must be at most 100")

    @property
    def number(self) -> float:
        """The load number P L^2/(E I)."""
        return self.load * self.length**2 / self.stiffness

    def _parameter(self) -> float:
        """Return m = k^2 of the elliptic integrals."""
        from scipy.optimize import root_scalar  # noqa: PLC0415 (loaded when used)
        from scipy.special import ellipkinc, ellipkm1  # noqa: PLC0415

        root = math.sqrt(self.number)

        def excess(gap: float) -> float:
            """Length at 1 - m = gap, less the bar's; a gap keeps its digits where m is near 1."""
            start = math.asin(math.sqrt(0.5 / (1 - gap)))
            return float(ellipkm1(gap) - ellipkinc(start, 1 - gap)) - root

        return 1.0 - root_scalar(excess, bracket=(1e-16, 0.5), xtol=1e-18, rtol=1e-14).root

    @property
    def tip_angle(self) -> float:
        """Rotation of the tip [rad]."""
        return math.asin(2 * self._parameter() - 1)

    def tip(self) -> tuple[float, float]:
        """Return the tip's deflection w and shortening u along the bar, both positive [m]."""
        x, w = self.shape(np.array([self.length]))[0]
        return float(w), float(self.length - x)

    def shape(self, s: np.ndarray) -> np.ndarray:
        """Return positions (x, deflection) [m] at arc lengths s (n,) [m], shape (n, 2).

        Raises
        ------
        InputError
            If an arc length is not on the bar.
        """
        from scipy.special import ellipeinc, ellipj, ellipkinc  # noqa: PLC0415

        s = np.asarray(s, dtype=float)
        if not ((s >= 0) & (s <= self.length)).all():
            raise InputError(f"elastica: arc lengths must be from 0 to {self.length:g} m")
        m, root = self._parameter(), math.sqrt(self.number)
        start = math.asin(math.sqrt(0.5 / m))
        phi = ellipj(root * s / self.length + ellipkinc(start, m), m)[3]
        scale = 2 * self.length / root
        x = scale * math.sqrt(m) * (math.cos(start) - np.cos(phi))
        return np.stack([x, s - scale * (ellipeinc(phi, m) - ellipeinc(start, m))], axis=-1)
