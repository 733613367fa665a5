"""The command line: ``optimise`` and ``stepnc``. A thin skin over :mod:`service.usecases`.

Data goes to stdout, messages and progress to stderr. Exit codes: 0 ok, 2 usage, 3 bad input,
4 infeasible, 5 limit exceeded, 130 interrupted. Imports of what is slow stay inside the
commands, so that ``--help`` answers at once.
"""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer

OK, BAD_INPUT, INFEASIBLE, INTERRUPTED = 0, 3, 4, 130

EPILOG = """Examples:

  optimise part.stpnc --mode TC --machine vmc15

  optimise part.stpnc --mode QC --roughness 1.6 --report part.html

  optimise part.stpnc --mode EC --dry-run --json
"""

stepnc = typer.Typer(
    name="stepnc",
    help="Read, check and optimise STEP-NC programs (ISO 14649).",
    no_args_is_help=True,
    add_completion=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

File = Annotated[Path, typer.Argument(metavar="FILE", help="A STEP-NC program (Part 21).")]
Units = Annotated[
    str,
    typer.Option(
        help="Units of feeds and speeds in the file: iso (m/s, rev/s), rpm-mmin, rpm-mmtooth, "
        "rpm-mmrev, revs-mmtooth or revs-mmrev."
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")]


@stepnc.command(epilog=EPILOG)
def optimise(
    file: File,
    mode: Annotated[
        str,
        typer.Option(
            help="TC least time, QC fastest feed that keeps the roughness, EC energy."
        ),
    ] = "TC",
    machine: Annotated[
        str, typer.Option(help="A machine of `stepnc machines`, or your own TOML or XML file.")
    ] = "",
    material: Annotated[
        str, typer.Option(help="A material of `stepnc materials`, or your own TOML file.")
    ] = "",
    units: Units = "iso",
    roughness: Annotated[
        float | None, typer.Option(help="Ra in µm that finished surfaces must keep.")
    ] = None,
    free: Annotated[
        str, typer.Option(help="What may change: feed, depth, speed (comma separated).")
    ] = "feed,depth",
    profile: Annotated[
        str, typer.Option(help="How records are written: optimisation or standard.")
    ] = "optimisation",
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Default: FILE.optimised.stpnc")
    ] = None,
    in_place: Annotated[
        bool, typer.Option("--in-place", help="Overwrite the input file.")
    ] = False,
    workingstep: Annotated[
        list[str] | None,
        typer.Option("--workingstep", help="Only this one (its id or #instance); repeatable."),
    ] = None,
    pareto: Annotated[
        bool, typer.Option("--pareto", help="Also the front of time, roughness and energy.")
    ] = False,
    tool_change_s: Annotated[
        float, typer.Option("--tool-change-s", help="Seconds to change a worn tool.")
    ] = 0.0,
    as_json: Json = False,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Write no STEP-NC file.")] = False,
    report: Annotated[
        Path | None, typer.Option("--report", help="Write a self-contained HTML page.")
    ] = None,
) -> None:
    """Optimise the feeds of FILE and write them back as STEP-NC."""
    from service import usecases, wire

    request = usecases.Request(
        file=file,
        mode=mode,
        machine=machine,
        material=material,
        units=units,
        roughness_um=roughness,
        free=free,
        profile=profile,
        output=output,
        in_place=in_place,
        workingsteps=tuple(workingstep or ()),
        pareto=pareto,
        tool_change=tool_change_s,
        dry_run=dry_run,
        report=report,
    )
    outcome = usecases.optimise(request, tell=_tell)
    if as_json:
        _print(wire.plan_json(outcome.plan))
    else:
        from service import tables

        tables.print_plan(outcome.plan)
    raise typer.Exit(INFEASIBLE if outcome.plan.is_infeasible else OK)


@stepnc.command()
def check(file: File, units: Units = "iso", as_json: Json = False) -> None:
    """Show what is in FILE, and what is wrong with it; exit 3 when it cannot be used."""
    from service import usecases, wire

    contents = usecases.check(file, units=units)
    if as_json:
        _print(wire.contents_json(contents))
    else:
        from service import tables

        tables.print_contents(contents)
    raise typer.Exit(OK if contents.is_usable else BAD_INPUT)


@stepnc.command()
def convert(
    file: File,
    profile: Annotated[str, typer.Option(help="optimisation or standard.")],
    output: Annotated[Path, typer.Option("-o", "--output", help="Where to write.")],
) -> None:
    """Move the optimisation records of FILE into the other profile, losing nothing."""
    from service import usecases

    usecases.convert(file, profile=profile, output=output)
    _tell(f"{output}: records in profile '{profile}'")


@stepnc.command()
def machines(
    name: Annotated[str, typer.Argument(help="Show this one in full.")] = "",
    as_json: Json = False,
) -> None:
    """List the machines, or show one."""
    _show_library("machines", name, as_json=as_json)


@stepnc.command()
def materials(
    name: Annotated[str, typer.Argument(help="Show this one in full.")] = "",
    as_json: Json = False,
) -> None:
    """List the materials, or show one."""
    _show_library("materials", name, as_json=as_json)


def main() -> None:
    """Run ``stepnc``."""
    _run(stepnc)


def optimise_main() -> None:
    """Run ``optimise``: the same as ``stepnc optimise``."""
    alone = typer.Typer(
        add_completion=True, pretty_exceptions_enable=False, rich_markup_mode=None
    )
    alone.command(name="optimise", epilog=EPILOG)(optimise)
    _run(alone)


def _run(app: Callable[..., object]) -> None:
    """Run an application and turn the project's errors into exit codes."""
    from stepnc_model.errors import StepNcError

    try:
        app()
    except StepNcError as error:
        _tell(f"error: {error}")
        sys.exit(_exit_code(error))
    except KeyboardInterrupt:
        _tell("interrupted: nothing was written")
        sys.exit(INTERRUPTED)
    except BrokenPipeError:
        # The reader of a pipe left (``| head``): no more to say, and nobody to hear it.
        sys.stderr.close()
        sys.exit(OK)


def _exit_code(error: Exception) -> int:
    """4 for limits that conflict, 3 for everything that is wrong with the input."""
    from optimiser.errors import OptimisationError

    return INFEASIBLE if isinstance(error, OptimisationError) else BAD_INPUT


def _show_library(kind: str, name: str, *, as_json: bool) -> None:
    """List a library, or show one entry of it."""
    from service import tables, usecases, wire

    if name:
        entry = usecases.library_entry(kind, name)
        _print(wire.entry_json(entry)) if as_json else tables.print_entry(entry)
        return
    entries = usecases.library_entries(kind)
    _print(wire.entries_json(entries)) if as_json else tables.print_entries(kind, entries)


def _print(text: str) -> None:
    """Data, to stdout."""
    sys.stdout.write(text + "\n")


def _tell(message: str) -> None:
    """A message, to stderr."""
    sys.stderr.write(message + "\n")
