"""The norms of manufactured problems as text."""

from __future__ import annotations

import math
from collections.abc import Mapping

from matpoint.problem import Result, failures


def errors_table(result: Result, norms: Mapping[str, str]) -> str:
    """Return aligned text: a line per method, what the norms mean, and why runs ended early.

    Parameters
    ----------
    result
        Method -> norms, and under "failed" None or where and why.
    norms
        Name of each norm -> its meaning.
    """
    width = max(len("method"), *(len(name) for name in result))
    columns = {norm: max(11, len(norm) + 2) for norm in norms}
    lines = ["method".ljust(width) + "".join(norm.rjust(w) for norm, w in columns.items())]
    lines.append("-" * len(lines[0]))
    for method, values in result.items():
        numbers = "".join(_shown(values[norm]).rjust(w) for norm, w in columns.items())
        lines.append(method.ljust(width) + numbers)
    longest = max(len(norm) for norm in norms)
    lines += ["", *(f"{norm:<{longest}}  {meaning}" for norm, meaning in norms.items())]
    failed = [f"{method} failed: {why}" for method, why in failures(result).items()]
    return "\n".join([*lines, "", *failed] if failed else lines)


def _shown(error: float) -> str:
    """Return an error with three digits; one that a run did not reach is a dash."""
    return f"{error:.3g}" if math.isfinite(error) else "-"
