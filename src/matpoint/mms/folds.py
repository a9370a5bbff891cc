"""Motions that turn a body inside out, found before a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from matpoint.errors import InputError
from matpoint.mms.soundness import refuse_infinite


def refuse_folds(
    deformation: Callable[[np.ndarray, float], np.ndarray], X: np.ndarray, times: Sequence[float] | np.ndarray
) -> None:
    """Refuse a motion whose det F is not above 0 at all of some places and times.

    Parameters
    ----------
    deformation
        F of reference positions (n, 3) [m] and a time [s], (n, 3, 3).
    X
        The places [m], (n, 3).
    times
        [s].

    Raises
    ------
    InputError
        With the place and the time where det F is least, or the first where F is no number.
    """
    lowest, where, when = np.inf, X[0], 0.0
    for time in times:
        with np.errstate(all="ignore"):
            F = deformation(X, float(time))
            J = _determinant(F)
        refuse_infinite({"F": lambda _X, _t, F=F: F}, X, [float(time)])
        least = int(np.argmin(J))  # of several with NaN the first
        if not J[least] >= lowest:
            lowest, where, when = float(J[least]), X[least], float(time)
        if np.isnan(lowest):
            break
    if not lowest > 0:
        place = ", ".join(f"{x:.4g}" for x in where)
        raise InputError(
            f"manufactured solution: the motion folds, det F = {_told(lowest)} at X = ({place}) m,"
            f" t = {when:.4g} s; a body can only be followed where det F > 0: use a smaller amplitude"
        )


def _told(J: float) -> str:
    return "(too large for a number)" if np.isnan(J) else f"{J:.4g}"


def _determinant(F: np.ndarray) -> np.ndarray:
    """Return det F by its terms: np.linalg.det takes ten times as long for so small matrices."""
    a, b, c = F[:, 0], F[:, 1], F[:, 2]
    return (
        a[:, 0] * (b[:, 1] * c[:, 2] - b[:, 2] * c[:, 1])
        - a[:, 1] * (b[:, 0] * c[:, 2] - b[:, 2] * c[:, 0])
        + a[:, 2] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    )
