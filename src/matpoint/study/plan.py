"""What a study will run, checked before anything is run or written."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from matpoint.checks import instance, whole
from matpoint.errors import InputError, naming
from matpoint.memory import refuse_size
from matpoint.problems import PROBLEMS, ManufacturedProblem
from matpoint.study.choices import changed, packed
from matpoint.study.worker import task
from matpoint.transfers import FLIP, Transfer

if TYPE_CHECKING:
    from matpoint.interpolation import Interpolation

#: Methods of a study: names, or labels with what each of them stands for.
Methods = Sequence[str] | Mapping[str, "Interpolation"]
_BYTES = 2000.0  # of a particle with the exact fields beside its own, measured
_MOST_WORK = 1e12  # particle-steps of a run; at a million a second they take eleven days


@dataclass(frozen=True, eq=False)
class Plan:
    """The runs of a study.

    Attributes
    ----------
    problem
        Its settings but for ``cells`` hold for all runs.
    methods
        Label -> interpolation.
    cells
        Sizes, ascending.
    transfer
        How velocities come back to the particles, in all runs.
    """

    problem: ManufacturedProblem
    methods: dict[str, Interpolation]
    cells: tuple[int, ...]
    transfer: Transfer

    @property
    def tasks(self) -> dict[tuple[str, int], dict[str, Any]]:
        """What workers are asked: label and cells -> task, the finest grids, which take longest, first."""
        return {
            (label, n): task(replace(self.problem, cells=n), choice, self.transfer)
            for n in reversed(self.cells)
            for label, choice in self.methods.items()
        }

    def heading(self) -> str:
        """Return in lines what is run: problem, transfer, order of stages, options that are no defaults."""
        orders: dict[str, list[str]] = {}
        for label, choice in self.methods.items():
            orders.setdefault(self.problem.scheme_for(choice).name.upper(), []).append(label)
        stages = "; ".join(f"{order} for {', '.join(labels)}" for order, labels in orders.items())
        lines = [
            f"{self.problem.name}: {changed(self.problem) or 'as it stands'}",
            f"transfer: {self.transfer!r}",
            f"stages: {next(iter(orders)) if len(orders) == 1 else stages}",
        ]
        options = {label: changed(choice) for label, choice in self.methods.items()}
        return "\n".join([*lines, *(f"{label}: {text}" for label, text in options.items() if text)])


def plan(
    problem: ManufacturedProblem,
    methods: Methods | None = None,
    cells: Sequence[int] | None = None,
    transfer: Transfer | None = None,
) -> Plan:
    """Return the runs of a study.

    Parameters
    ----------
    problem
        Its settings but for ``cells`` are kept.
    methods
        Names, or label -> interpolation to compare variants; None takes the problem's.
    cells
        Sizes; None takes the problem's.
    transfer
        How velocities come back; None takes FLIP().

    Raises
    ------
    InputError
        If a method or a size does not exist, a method can't go with the transfer or the order of stages, or
        a run would be too large.
    """
    given = FLIP() if transfer is None else transfer
    instance("converge: transfer", given, Transfer, "FLIP(blend), PIC(), APIC(), XPIC(order) or FMPM(order)")
    chosen = _chosen(problem, methods)
    sizes = tuple(
        sorted({whole("converge: cells", n, 2) for n in (problem.sizes if cells is None else cells)})
    )
    if not sizes:
        raise InputError("converge: no cells given, for instance --cells 8,16,32")
    if PROBLEMS.get(problem.name) is not type(problem):
        raise InputError(
            f"converge: {type(problem).__name__} is no problem that a worker process knows (matpoint list);"
            " measure it in this process with problem.track(method) and problem.measure"
        )
    for label, choice in chosen.items():
        packed(choice)
        _refuse(problem, label, choice, given)
    for n in sizes:
        refuse_problem_size(replace(problem, cells=n))
    if problem.dt:
        _refuse_step(replace(problem, cells=sizes[0]), chosen, given)
    return Plan(problem, chosen, sizes, given)


def _chosen(problem: ManufacturedProblem, methods: Methods | None) -> dict[str, Interpolation]:
    from matpoint.interpolation import METHODS, Interpolation  # noqa: PLC0415 (compiles)

    if not isinstance(methods, Mapping):
        return {name: METHODS[name] for name in problem.chosen(methods)}
    for label, choice in methods.items():
        instance(f"converge: methods[{label!r}]", choice, Interpolation, "an interpolation, such as IMLS()")
    if not methods:
        raise InputError("converge: no method given")
    return dict(methods)


def _refuse(problem: ManufacturedProblem, label: str, choice: Interpolation, transfer: Transfer) -> None:
    """Refuse a method that can't go with the transfer, the order of stages, the walls or the particles."""
    try:
        problem.refuse(choice, transfer)
    except InputError as error:
        text = str(error).removeprefix(f"{problem.name}: ")
        text = text if text.startswith(label) else f"{label}: {text}"
        raise InputError(f"converge: {text}; or leave {label} out of the methods") from None


def _refuse_step(coarsest: ManufacturedProblem, chosen: Mapping[str, Interpolation], given: Transfer) -> None:
    """Refuse a step of the user's that is over the limit on the coarsest cells, and so on all."""
    for label, choice in chosen.items():
        with naming(f"converge: {label} on {coarsest.cells} cells"):
            coarsest.simulation(choice, scheme=coarsest.scheme_for(choice, given), threads=1)


def refuse_problem_size(problem: ManufacturedProblem) -> None:
    """Refuse a size that memory can't hold, or that would run for weeks.

    Raises
    ------
    InputError
        With the sizes, and what would help.
    """
    where = f"{problem.name} on {problem.cells} cells"
    # The grid itself may be too large to be described.
    particles, dim = problem.particle_count(), replace(problem, cells=4).grid().dim
    refuse_size(
        where, float(problem.cells + 1) ** dim, particles, "use fewer cells, or a smaller per_cell", _BYTES
    )
    steps = problem.end / problem.step
    if particles * steps > _MOST_WORK:
        raise InputError(
            f"{where}: {particles:.3g} particles for {steps:.3g} steps make {particles * steps:.3g}"
            f" particle-steps; up to {_MOST_WORK:.0e}, some eleven days, are allowed: use fewer cells"
        )
