"""Blocks of finite-element cells for the tests of solids."""

from __future__ import annotations

import numpy as np

from matpoint.reference.solid import Solid

LAME, SHEAR, RHO = 3.0, 2.0, 1.5
HEX_TETS = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]


def block(kind, counts, lengths=(1.0, 1.0, 1.0), shake=0.0):
    """A box of cells; inner vertices are moved by a share of the spacing."""
    d = 2 if kind in ("quad", "tri") else 3
    counts = tuple(counts)[:d]
    index = np.indices([n + 1 for n in counts]).reshape(d, -1).T
    X = index * np.array(lengths[:d]) / counts
    inner = ((index > 0) & (index < counts)).all(axis=1)
    noise = np.random.default_rng(1).uniform(-shake, shake, X.shape)
    X = X + inner[:, None] * noise * np.array(lengths[:d]) / counts
    number = np.arange(len(X)).reshape([n + 1 for n in counts])
    a, b = slice(None, -1), slice(1, None)
    if d == 2:
        corners = [(a, a), (b, a), (b, b), (a, b)]
    else:
        corners = [(*c, z) for z in (a, b) for c in ((a, a), (b, a), (b, b), (a, b))]
    cells = np.stack([number[c].ravel() for c in corners], axis=1)
    if kind == "tri":
        cells = cells[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    if kind == "tet":
        cells = cells[:, HEX_TETS].reshape(-1, 4)
    return X, cells


def solid(kind, counts, lengths=(1.0, 1.0, 1.0), shake=0.0):
    X, cells = block(kind, counts, lengths, shake)
    return Solid(np.pad(X, ((0, 0), (0, 3 - X.shape[1]))), cells, kind, LAME, SHEAR, RHO)


def boundary(X, lengths=(1.0, 1.0, 1.0)):
    return np.flatnonzero(((X == 0) | (np.array(lengths[: X.shape[1]]) == X)).any(axis=1))
