"""Finding an order, and putting rows in it without a second array."""

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


@kernel
def counted_order(key, counts, order):
    """Write the stable order of keys from 0 to len(counts) - 2; counts, of zeros, is used up."""
    for k in key:
        counts[k + 1] += 1
    for c in range(1, counts.shape[0]):
        counts[c] += counts[c - 1]
    for p in range(key.shape[0]):
        order[counts[key[p]]] = p
        counts[key[p]] += 1
