"""The commands; each imports what it needs when it runs."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import App, Parameter

from matpoint._version import __version__
from matpoint.errors import InputError

app = App(
    name="matpoint",
    help="The Material Point Method: CPDI2 and its enrichment, GIMP, B-splines, and proof for all of them.",
    version=__version__,
    suppress_keyboard_interrupt=False,  # the exit says what it left
)

Settings = Annotated[
    list[str],
    Parameter(name="--set", negative=(), help="Override a value: table.key=value (may be repeated)."),
]
Plugin = Annotated[
    list[Path],
    Parameter(name="--plugin", negative=(), help="A Python file that registers materials. It is run."),
]
Out = Annotated[Path | None, Parameter(name="--out", help="Output folder; default results/CASE.")]
VerifyOut = Annotated[
    Path | None, Parameter(name="--out", help="Output folder; default results/verify-CASE.")
]
PaperOut = Annotated[
    Path | None, Parameter(name="--out", help="Output folder; default results/reproduce-PAPER.")
]
Threads = Annotated[int | None, Parameter(name="--threads", help="Number of threads; default all.")]
Json = Annotated[
    bool,
    Parameter(
        name="--json",
        negative=(),
        help="Print one JSON object only; without --out no figures are drawn and nothing is written.",
    ),
]
Force = Annotated[
    bool,
    Parameter(
        name="--force",
        negative=(),
        help="Write to a folder that holds something. Files that earlier runs wrote there, listed in its"
        " .matpoint-files, are removed first; no other file is removed or overwritten.",
    ),
]


def _announce_compiling() -> None:
    """Say so, once, if kernels must be compiled; old caches go when a new one begins."""
    from matpoint.jit import on_first_compilation, prune_caches  # noqa: PLC0415 (slow to import)

    def begin() -> None:
        print("compiling kernels (a first run takes some 10 to 60 s) ...", file=sys.stderr, flush=True)
        prune_caches()

    on_first_compilation(begin)


def _load(case: str, settings: list[str], plugins: list[Path], quiet: bool = False) -> Any:
    from matpoint.case import load  # noqa: PLC0415 (slow to import)
    from matpoint.cli.plugins import load_plugin  # noqa: PLC0415

    if not quiet:
        _announce_compiling()
    for plugin in plugins:
        load_plugin(plugin)
    return load(case, settings)


def _keep(inputs: Sequence[str | Path], folder: Path) -> None:
    """Refuse an output folder that holds an input of this run: it could be removed or overwritten."""
    for given in inputs:
        path = Path(given)
        if path.is_file() and folder.resolve() in (path.resolve().parent, path.absolute().parent.resolve()):
            raise InputError(f"output: {folder} holds {given} itself; choose another folder with --out")


def _only_problem(settings: Sequence[str]) -> None:
    """Refuse settings that verify, with methods and times of its own, would pass over."""
    for setting in settings:
        if setting.split("=")[0].split(".")[0].strip() != "problem":
            raise InputError(
                f"--set {setting!r}: the methods and times are the problem's own here; set problem.*"
            )


@app.command
def run(
    case: str,
    /,
    *,
    out: Out = None,
    set_: Settings = [],  # noqa: B006 (never changed)
    threads: Threads = None,
    force: Force = False,
    plugin: Plugin = [],  # noqa: B006 (never changed)
    restart: Annotated[Path | None, Parameter(name="--restart", help="Go on from a checkpoint.")] = None,
    quiet: Annotated[bool, Parameter(name="--quiet", negative=(), help="Show no progress.")] = False,
) -> None:
    """Run a case and write its results.

    Parameters
    ----------
    case
        A TOML file, or the name of a bundled case (see ``matpoint list``).
    """
    from matpoint.case import build_simulation, build_writers, planned  # noqa: PLC0415 (slow to import)
    from matpoint.output import Progress, prepare_folder, resume  # noqa: PLC0415

    read = _load(case, set_, plugin, quiet)
    folder = Path("results") / read.name if out is None else out
    _keep([case, *plugin, *([] if restart is None else [restart])], folder)
    simulation = build_simulation(read, threads)
    writers = build_writers(read, folder, simulation)
    if restart is not None:
        resume(simulation, restart)
        if simulation.time >= read.tables.time.end:
            raise InputError(
                f"restart: the checkpoint is at {simulation.time:g} s; time.end = {read.tables.time.end:g} s"
            )
    prepare_folder(folder, force, planned(writers))
    said = [note for note in simulation.notes if note.startswith("time step: ")]  # came as a warning
    try:
        simulation.run(read.tables.time.end, writers, Progress(quiet))
    finally:
        for note in (n for n in simulation.notes if n not in said):
            print(f"note: {note}", file=sys.stderr)
    print(f"{read.name}: {simulation.step} steps to t = {simulation.time:g} s; results in {folder}")


@app.command
def verify(
    case: str,
    /,
    *,
    json_: Json = False,
    set_: Settings = [],  # noqa: B006 (never changed)
    methods: Annotated[str | None, Parameter(name="--methods", help="Names, separated by commas.")] = None,
    out: VerifyOut = None,
    force: Force = False,
) -> None:
    """Run a problem by all methods, and measure them against its reference.

    Exit code 3 if no run reached its end, or one without which there is no comparison. Of manufactured
    problems a method that fails is named, with its step and why, and the others go on.

    Parameters
    ----------
    case
        A case with a ``[problem]``: a TOML file or a bundled name.
    """
    from matpoint.case import make_problem  # noqa: PLC0415 (slow to import)
    from matpoint.errors import RunError, StudyError  # noqa: PLC0415
    from matpoint.output import prepare_folder  # noqa: PLC0415
    from matpoint.output.summary import plain, write_json  # noqa: PLC0415
    from matpoint.problems import ManufacturedProblem  # noqa: PLC0415
    from matpoint.study.plan import refuse_problem_size  # noqa: PLC0415

    _only_problem(set_)
    read = _load(case, set_, [])
    if read.tables.problem is None:
        raise InputError(f"case {case}: it has no [problem] to verify; use matpoint run")
    problem = make_problem(read.tables.problem)
    names = problem.chosen(None if methods is None else [m.strip() for m in methods.split(",")])
    if isinstance(problem, ManufacturedProblem):
        refuse_problem_size(problem)
    problem.refuse_methods(names)
    folder = Path("results") / f"verify-{read.name}" if out is None and not json_ else out
    if folder is not None:
        _keep([case], folder)
        prepare_folder(folder, force, [*problem.files, "verify.json"])

    running = ""

    def announce(name: str, number: int, count: int) -> None:
        nonlocal running
        running = name
        print(f"[{number + 1}/{count}] {name}", file=sys.stderr, flush=True)

    try:
        result = problem.verify(names, folder, announce)
    except RunError as error:
        raise StudyError(f"{read.name}: {running} failed: {error}; --methods can leave it out") from None
    if folder is not None:
        write_json(folder / "verify.json", result)
    if json_:
        print(json.dumps(plain(result), allow_nan=False))
    else:
        print(problem.table(result))
        print(f"\nfigures and verify.json in {folder}")
    problem.refuse_failure(result)


@app.command
def converge(
    case: str,
    /,
    *,
    cells: Annotated[str | None, Parameter(name="--cells", help="Sizes, separated by commas.")] = None,
    methods: Annotated[str | None, Parameter(name="--methods", help="Names, separated by commas.")] = None,
    json_: Json = False,
    set_: Settings = [],  # noqa: B006 (never changed)
    out: Out = None,
    force: Force = False,
    fresh: Annotated[
        bool, Parameter(name="--fresh", negative=(), help="Run again what earlier studies have kept.")
    ] = False,
) -> None:
    """Run methods at several sizes of a manufactured problem; print errors, orders and cost.

    ``--set`` takes ``problem.*``, ``scheme.*`` (transfer, blend, terms, order) and options of
    ``interpolation.*``, for all methods alike. Exit code 3 if no run reached its end. Run again with more
    cells or methods, a study in the output folder is extended, without ``--force``.

    Parameters
    ----------
    case
        A case with a ``[problem]`` whose solution is manufactured: a TOML file or a bundled name.
    """
    from matpoint.cli import converging  # noqa: PLC0415 (slow to import)
    from matpoint.cli.study_folder import study_folder  # noqa: PLC0415
    from matpoint.output.summary import plain  # noqa: PLC0415
    from matpoint.study import carry_out, plan  # noqa: PLC0415

    if any(key.split("=")[0].strip() == "problem.cells" for key in set_):
        raise InputError("--set problem.cells: the sizes of a study are given with --cells")
    keys = converging.split_settings(set_)
    read = _load(case, set_, [])
    problem, transfer = converging.read_scheme(read, keys["scheme"], converging.read_problem(read, case))
    names = problem.chosen(None if methods is None else [m.strip() for m in methods.split(",")])
    chosen = converging.read_methods(read, keys["interpolation"], names)
    planned = plan(problem, chosen, converging.whole_numbers(cells), transfer)
    folder = Path("results") / f"converge-{read.name}" if out is None and not json_ else out
    if folder is not None:
        _keep([case], folder)
        study_folder(folder, force, planned)
    study = carry_out(planned, fresh, announce=lambda text: print(text, file=sys.stderr, flush=True))
    if folder is not None:
        converging.write_all(study, folder)
    if json_:
        print(json.dumps(plain(study.json()), allow_nan=False))
    else:
        print(study.tables())
        print(f"\nfigures, table.txt, converge.json and settings.json in {folder}")
    study.refuse_failure()


@app.command
def reproduce(
    paper: str,
    /,
    *,
    out: PaperOut = None,
    force: Force = False,
    quick: Annotated[
        bool, Parameter(name="--quick", negative=(), help="Longer steps, fewer resolutions.")
    ] = False,
) -> None:
    """Make every figure of a paper, and tables, in one folder, with the settings used.

    Parameters
    ----------
    paper
        ``cpdi2``: the enriched CPDI2 paper, the bi-material bar and ring. ``imls``: the IMLS paper, its
        polynomials and its convergence.
    """
    from matpoint.errors import did_you_mean  # noqa: PLC0415 (slow to import)
    from matpoint.output import prepare_folder  # noqa: PLC0415
    from matpoint.reproduce import PAPERS  # noqa: PLC0415

    if paper not in PAPERS:
        raise InputError(f"reproduce: {paper!r}{did_you_mean(paper, PAPERS)}; there is {', '.join(PAPERS)}")
    _announce_compiling()
    folder = Path("results") / f"reproduce-{paper}" if out is None else out
    prepare_folder(folder, force, ["*.png", "*.csv", "table.*", "settings.json"])
    PAPERS[paper](folder, lambda text: print(text, file=sys.stderr, flush=True), quick)
    print((folder / "table.md").read_text(encoding="utf-8"))
    print(f"figures, table.md, table.json and settings.json in {folder}")


@app.command
def bench(
    *,
    json_: Annotated[bool, Parameter(name="--json", negative=(), help="Print one JSON object only.")] = False,
    quick: Annotated[
        bool, Parameter(name="--quick", negative=(), help="Under a minute: fewer particles and rounds.")
    ] = False,
    particles: Annotated[
        str | None, Parameter(name="--particles", help="About so many in each row; default 2e5.")
    ] = None,
    methods: Annotated[str | None, Parameter(name="--methods", help="Rows, separated by commas.")] = None,
    dims: Annotated[str | None, Parameter(name="--dims", help="2, 3 or 2,3 (default).")] = None,
    threads: Annotated[
        str | None, Parameter(name="--threads", help="Numbers of threads; default one and all: 1,N.")
    ] = None,
    scale: Annotated[
        str | None,
        Parameter(
            name="--scale",
            help="Study time and memory over these numbers of particles, for instance 1e4,1e5,1e6, in 3-D.",
        ),
    ] = None,
    out: Annotated[
        Path | None, Parameter(name="--out", help="A folder for JSON, table and figure; default none.")
    ] = None,
    force: Force = False,
) -> None:
    """Measure particle-steps a second of every interpolation, against C++ loops and memory bandwidth."""
    from matpoint.cli.benching import bench as measure  # noqa: PLC0415 (slow to import)
    from matpoint.cli.benching import chosen, numbers_of  # noqa: PLC0415

    options = chosen(particles, methods, dims, threads, quick)
    result, text = measure(options, numbers_of("--scale", scale), methods is not None, out, force)
    print(json.dumps(result, allow_nan=False) if json_ else text)


@app.command(name="list")
def list_() -> None:
    """List bundled cases, problems, interpolations, materials, schemes and quantities."""
    from matpoint.cli.report import listing  # noqa: PLC0415 (slow to import)

    print(listing())


@app.command
def explain(
    case: str,
    /,
    *,
    set_: Settings = [],  # noqa: B006 (never changed)
    plugin: Plugin = [],  # noqa: B006 (never changed)
) -> None:
    """Print what a step of a case does: stage, equation, arrays read, arrays written.

    Parameters
    ----------
    case
        A TOML file, or the name of a bundled case.
    """
    from matpoint.case import build_simulation  # noqa: PLC0415 (slow to import)
    from matpoint.cli.report import explanation  # noqa: PLC0415

    read = _load(case, set_, plugin)
    print(explanation(read, build_simulation(read, threads=1)))


@app.command
def info(
    case: str | None = None,
    /,
    *,
    set_: Settings = [],  # noqa: B006 (never changed)
    plugin: Plugin = [],  # noqa: B006 (never changed)
) -> None:
    """Print versions, threads, vector width and the cache folder; of a case, the memory that it needs.

    Parameters
    ----------
    case
        A TOML file, or the name of a bundled case.
    """
    from matpoint.cli.report import information, requirement  # noqa: PLC0415 (slow to import)

    if case is None:
        print(information())
        return
    from matpoint.case import build_forecast  # noqa: PLC0415 (slow to import)

    read = _load(case, set_, plugin)
    print(requirement(read.name, build_forecast(read)))


@app.command
def cite(
    case: str,
    /,
    *,
    set_: Settings = [],  # noqa: B006 (never changed)
    plugin: Plugin = [],  # noqa: B006 (never changed)
) -> None:
    """Print BibTeX entries of exactly the methods that a case uses.

    Parameters
    ----------
    case
        A TOML file, or the name of a bundled case.
    """
    from matpoint.case import build_simulation  # noqa: PLC0415 (slow to import)
    from matpoint.citations import bibtex  # noqa: PLC0415

    print(bibtex(build_simulation(_load(case, set_, plugin), threads=1).citation))


@app.command
def schema() -> None:
    """Print the JSON schema of case files, for editors that complete and check them."""
    from matpoint.case import CaseTable  # noqa: PLC0415 (slow to import)

    print(json.dumps(CaseTable.model_json_schema(), indent=2))
