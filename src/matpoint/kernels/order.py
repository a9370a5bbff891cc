"""Putting rows in an order without a second array."""

from __future__ import annotations

from matpoint.jit import kernel


@kernel
def reorder(order, rows, done, held):
    """Let row k of rows (n, bytes) become what row order[k] was, one cycle of the permutation at a time.

    ``done`` (n,) is False throughout, and is so again at the end; ``held`` (bytes,) keeps a row.
    """
    for start in range(order.shape[0]):
        if done[start] or order[start] == start:
            done[start] = False
            continue
        for b in range(held.shape[0]):
            held[b] = rows[start, b]
        k = start
        while order[k] != start:
            source = order[k]
            for b in range(held.shape[0]):
                rows[k, b] = rows[source, b]
            done[source] = True
            k = source
        for b in range(held.shape[0]):
            rows[k, b] = held[b]
