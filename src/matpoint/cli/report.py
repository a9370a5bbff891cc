"""The texts of ``list``, ``explain`` and ``info``."""

from __future__ import annotations

import platform
import re
import tomllib
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

from matpoint._version import __version__

if TYPE_CHECKING:
    from matpoint.case import Case
    from matpoint.footprint import Forecast
    from matpoint.simulation import Simulation


# What Python calls a lambda, or a function that was made inside another.
_NAMELESS = re.compile(r"[\w.<>]*<(?:locals|lambda)>[\w.<>]*")


def _first_line(thing: Any) -> str:
    return (thing.__doc__ or "").strip().splitlines()[0]


def _block(title: str, rows: dict[str, str]) -> str:
    width = max(len(name) for name in rows)
    return "\n".join([title, *(f"  {name:<{width}}  {text}" for name, text in rows.items())])


def listing() -> str:
    """Return everything that a case file can name, with a line on each."""
    from matpoint.case import bundled_cases  # noqa: PLC0415 (slow to import)
    from matpoint.interpolation import METHODS  # noqa: PLC0415
    from matpoint.materials import MATERIALS  # noqa: PLC0415
    from matpoint.problems import PROBLEMS  # noqa: PLC0415
    from matpoint.quantities import QUANTITIES  # noqa: PLC0415
    from matpoint.scheme import SCHEMES  # noqa: PLC0415
    from matpoint.transfers import TRANSFERS  # noqa: PLC0415

    cases = {name: tomllib.loads(text).get("title", "") for name, text in bundled_cases().items()}
    blocks = {
        "cases": cases,
        "problems (matpoint verify)": {name: p.title for name, p in PROBLEMS.items()},
        "interpolations": {name: _first_line(type(i)) for name, i in METHODS.items()},
        "materials": {name: _first_line(m) for name, m in MATERIALS.items()},
        "schemes": {name: _first_line(s) for name, s in SCHEMES.items()},
        "transfers": {name: _first_line(t) for name, t in TRANSFERS.items()},
        "quantities (output.history)": {
            name: f"{q.description} [{q.unit}]" for name, q in QUANTITIES.items()
        },
    }
    return "\n\n".join(_block(title, rows) for title, rows in blocks.items())


def explanation(case: Case, sim: Simulation) -> str:
    """Return what a case is and what a step of it does."""
    from matpoint.fingerprint import spelled  # noqa: PLC0415 (slow to import)
    from matpoint.timestep import quiet_step, stable_step  # noqa: PLC0415

    def said(thing: Any) -> str:
        return _NAMELESS.sub("a function", spelled(thing))

    corners, enriched = sim.engine.mapping.corners, sim.engine.mapping.nodes.extra
    sizes = f"{len(sim.particles)} particles, {sim.engine.mapping.nodes.on_grid} grid nodes"
    if corners:
        sizes += f", {corners} vertices, {enriched} of them enriched"
    step = f"dt = {sim.dt:.4g} s, stable up to {stable_step(sim):.4g} s"
    quiet = quiet_step(sim)
    if quiet is not None:
        step += f" with its consistent mass; in long runs noise grows above {quiet:.4g} s"
    head = {
        "case": f"{case.name}: {case.tables.title}" if case.tables.title else case.name,
        "method": f"{sim.interpolation.name}, {sim.interpolation!r}",
        "scheme": f"{sim.scheme.name} with {sim.scheme.transfer!r}",
        "materials": "; ".join(said(m) for m in sim.materials),
        "size": f"{sim.dim}-D, {sizes}",
        "boundaries": "; ".join(said(c) for c in sim.boundaries) or "none",
        "loads": "; ".join(said(load) for load in sim.loads) or "none",
        "damping": said(sim.engine.damping),
        "step": step,
    }
    return _block("what", head) + "\n\nstages of a step\n" + sim.explain()


def information() -> str:
    """Return versions and what the machine gives."""
    import llvmlite.binding as llvm  # noqa: PLC0415 (slow to import)

    from matpoint.jit import cache_folder  # noqa: PLC0415
    from matpoint.threads import available_threads  # noqa: PLC0415

    features = llvm.get_host_cpu_features()
    width = next((w for name, w in (("avx512f", 512), ("avx", 256)) if features.get(name)), 128)
    rows = {"matpoint": __version__, "python": platform.python_version()}
    for name in ("numpy", "scipy", "numba", "llvmlite", "h5py", "matplotlib", "scikit-fem", "vtk"):
        try:
            rows[name] = version(name)
        except PackageNotFoundError:
            rows[name] = "not installed"
    rows["processor"] = llvm.get_host_cpu_name()
    rows["threads"] = str(available_threads())
    rows["vector width"] = f"{width} bits, {width // 64} float64 lanes"
    rows["cache"] = str(cache_folder())
    return _block("matpoint", rows)


def _size(count: float) -> str:
    """Return a number of bytes in the unit that suits it."""
    for unit in ("bytes", "kB", "MB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} GB"


def requirement(name: str, need: Forecast) -> str:
    """Return the memory that a case needs, group by group."""
    rows = {}
    for what, part in (("particles", need.particles), ("nodes", need.nodes)):
        rows[f"{part.count:.4g} {what}"] = (
            f"{sum(part.bytes_each.values()):.0f} bytes each, {_size(part.total)} in all:"
            f" {', '.join(f'{group} {size:.0f}' for group, size in part.bytes_each.items())}"
        )
    rows["in all"] = f"about {_size(need.total)}; {_size(need.free)} are free"
    return _block(f"memory of {name}", rows)
