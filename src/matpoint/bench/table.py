"""The benchmark as text."""

from __future__ import annotations

from typing import Any

_HEAD = (
    "method", "dim", "threads", "particles", "Mps", "min", "max", "ns", "cost", "speed-up", "enriched",
)  # fmt: skip


def _number(value: float | None, form: str = ".2f") -> str:
    return "-" if value is None else format(value, form)


def aligned(head: tuple[str, ...], lines: list[tuple[str, ...]]) -> str:
    """Return rows of words in columns, the first to the left, the others to the right."""
    widths = [max(len(line[k]) for line in (head, *lines)) for k in range(len(head))]
    text = []
    for first, *others in (head, *lines):
        words = [word.rjust(width) for word, width in zip(others, widths[1:], strict=True)]
        text.append("  ".join([first.ljust(widths[0]), *words]))
    return "\n".join(text)


def _row(row: dict[str, Any]) -> tuple[str, ...]:
    share = row["enriched_share"]
    return (
        row["interpolation"], f"{row['dim']}-D", str(row["threads"]), str(row["particles"]),
        _number(row["mps"]), _number(row["mps_min"]), _number(row["mps_max"]), _number(row["ns"], ".0f"),
        _number(row["cost"]), _number(row["speed_up"]), f"{100 * share:.1f} %" if share else "-",
    )  # fmt: skip


def stages(result: dict[str, Any]) -> str:
    """Return nanoseconds of each stage, and in brackets its share of the bandwidth's limit."""
    names = list(dict.fromkeys(name for row in result["rows"] for name in row["stages"]))
    lines = []
    for row in result["rows"]:
        cells = []
        for name in names:
            stage = row["stages"].get(name)
            text = "-" if stage is None else f"{stage['ns']:.1f}"
            if stage is not None and stage["of_bandwidth"] is not None and stage["ns"] >= 0.05:
                text += f" ({100 * stage['of_bandwidth']:.0f} %)"
            cells.append(text)
        lines.append((f"{row['interpolation']} {row['dim']}-D/{row['threads']}", *cells))
    return aligned(("method dim/threads", *names), lines)


def _others(result: dict[str, Any]) -> list[str]:
    gbs = ", ".join(f"{v:.1f} GB/s on {k}" for k, v in result["triad"]["gbs"].items())
    lines = [f"triad: {gbs} threads (24 bytes an element; what a write reads first is not counted)"]
    native = result["native"]
    if native is not None:
        parts = ", ".join(f"{name} {s['ns']:.1f}" for name, s in native["stages"].items())
        lines.append(
            f"native: {native['mps']:.2f} Mps ({native['mps_min']:.2f} to {native['mps_max']:.2f}),"
            f" {native['ns']:.0f} ns: {parts}; {native['compiler']}"
        )
    for row in result["rows"]:
        if row["against_native"] is not None:
            lines.append(f"bspline2, 3-D, one thread: {row['against_native']:.2f} times the native program")
    if result["taichi"] is not None:
        for one in result["taichi"]["all"]:
            lines.append(
                f"{one['package']} {one['version']}, threads: {one['threads']}: {one['mps']:.2f} Mps"
            )
        lines += _against(result)
    return lines + [f"note: {note}" for note in result["notes"]]


def _against(result: dict[str, Any]) -> list[str]:
    """The same step on the same number of threads as the fastest of Taichi and Quadrants."""
    best = result["taichi"]
    for row in result["rows"]:
        if (row["interpolation"], row["dim"], row["threads"]) == ("bspline2", 3, best["threads"]):
            ratio = row["mps"] / best["mps"]
            return [f"bspline2, 3-D, threads: {row['threads']}: {ratio:.1f} times {best['package']}"]
    return []


def table(result: dict[str, Any]) -> str:
    """Return what ``matpoint bench`` prints.

    Parameters
    ----------
    result
        Of :func:`matpoint.bench.suite.run_bench`.
    """
    machine = result["machine"]
    head = (
        f"million particle-steps a second (Mps), medians of {result['rounds']} rounds of"
        f" {result['steps_per_round']} steps; {machine['processor']}, matpoint {machine['matpoint']}\n"
        "cost: against linear in the same dimension on the same threads; speed-up: against one thread"
    )
    rows = aligned(_HEAD, [_row(row) for row in result["rows"]])
    about = "stages [ns per particle-step] (share of the triad's bandwidth; above 100 % arrays stay in cache)"
    return "\n".join([head, "", rows, "", about, stages(result), "", *_others(result)])
