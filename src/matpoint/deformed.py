"""A start in a deformed state: where a body's points lie at t = 0, and how they are stretched there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from matpoint.checks import function
from matpoint.errors import InputError

Map = Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Start:
    """A body that begins deformed; its region or mesh is given in the reference configuration.

    Parameters
    ----------
    position
        Reference positions X (n, 3) [m] -> positions x(X) at the start (n, 3) [m].
    deformation
        Reference positions X (n, 3) [m] -> deformation gradients F = dx/dX at the start (n, 3, 3).

    Raises
    ------
    InputError
        If one of them is no function.
    """

    position: Map
    deformation: Map

    def __post_init__(self) -> None:
        function("start: position", self.position)
        function("start: deformation", self.deformation)

    def place(self, X: np.ndarray, label: str = "body") -> np.ndarray:
        """Return positions at the start [m] of reference positions (n, 3) [m].

        Raises
        ------
        InputError
            If they are not (n, 3) finite numbers.
        """
        return _checked(self.position(X), X.shape, f"{label}: start.position")

    def stretch(self, X: np.ndarray, label: str = "body") -> np.ndarray:
        """Return F [-] at the start, (n, 3, 3), of reference positions (n, 3) [m].

        Raises
        ------
        InputError
            If they are not (n, 3, 3) finite numbers, or a determinant is not positive.
        """
        F = _checked(self.deformation(X), (len(X), 3, 3), f"{label}: start.deformation")
        bad = np.flatnonzero(np.linalg.det(F) <= 0.0)
        if len(bad):
            at = ", ".join(f"{c:g}" for c in X[bad[0]])
            raise InputError(f"{label}: start.deformation: det F is not positive at X = ({at}) m")
        return F


def _checked(values: np.ndarray, shape: tuple[int, ...], what: str) -> np.ndarray:
    found = np.asarray(values, dtype=float)
    if found.shape != shape or not np.isfinite(found).all():
        raise InputError(f"{what} must return finite values of shape {shape}, not {found.shape}")
    return found
