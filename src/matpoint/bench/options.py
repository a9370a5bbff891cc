"""What a benchmark measures, checked before anything is computed."""

from __future__ import annotations

from dataclasses import dataclass

from matpoint.bench.block import METHODS, PER_CELL
from matpoint.checks import whole
from matpoint.errors import InputError, did_you_mean
from matpoint.threads import available_threads

MOST = 100_000_000  # particles
RECONSTRUCTION_SHARE = 8  # rows of the reconstructions, dear as they are, get this many times fewer particles


@dataclass(frozen=True)
class BenchOptions:
    """The choice of rows, and how long to measure them.

    Parameters
    ----------
    particles
        About so many in each row; IMLS gets an eighth.
    methods
        Names of rows, keys of ``matpoint.bench.block.METHODS``.
    dims
        2, 3 or both.
    threads
        Numbers of threads; empty for one and all.
    rounds
        Of ten steps each; medians are taken over them.
    triad_elements
        float64 numbers in each of the triad's three arrays.
    rivals
        Whether Taichi and Quadrants run too, if installed.

    Raises
    ------
    InputError
        If one of these can't be.
    """

    particles: int = 200_000
    methods: tuple[str, ...] = tuple(METHODS)
    dims: tuple[int, ...] = (2, 3)
    threads: tuple[int, ...] = ()
    rounds: int = 7
    triad_elements: int = 16_000_000
    rivals: bool = True

    def __post_init__(self) -> None:
        if whole("bench: particles", self.particles) > MOST:
            raise InputError(f"bench: particles = {self.particles!r} must be at most {MOST}")
        for name in self.methods:
            if name not in METHODS:
                near = did_you_mean(name, METHODS)
                raise InputError(f"bench: there is no method {name!r}{near}; there is {', '.join(METHODS)}")
        for dim in self.dims:
            if dim not in PER_CELL:
                raise InputError(f"bench: dims = {dim!r}; 2 and 3 are allowed")
        for count in self.threads:
            if whole("bench: threads", count) > 1024:
                raise InputError(f"bench: threads = {count!r} must be from 1 to 1024")
        whole("bench: rounds", self.rounds)
        whole("bench: triad elements", self.triad_elements)
        for name in ("methods", "dims"):
            given = getattr(self, name)
            if not given or len(set(given)) < len(given):
                raise InputError(f"bench: {name} = {list(given)} must name one or more, each once")
        object.__setattr__(self, "threads", tuple(dict.fromkeys(self.threads or (1, available_threads()))))

    def particles_of(self, name: str) -> int:
        """Return about how many particles a row gets."""
        return max(1, self.particles // (RECONSTRUCTION_SHARE if name.startswith("imls") else 1))
