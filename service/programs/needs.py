"""Data that a STEP-NC program lacks for advice and simulation, as one complete command.

Tools of which a file has only the name, technologies without a feed or a speed, tool data
without which nothing can be computed, and the material. What is missing stands as a name in
capitals in the command.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from math import isclose
from shlex import quote
from typing import Any

from optimiser.cuts.bare_path import UNKNOWN_DEPTH, is_path_only
from optimiser.cuts.fixtured_stock import assumed_stock
from service.programs.machine_choice import DEFAULT_LATHE, DEFAULT_MILL, material_for
from service.programs.reading import FEEDS
from service.requests.program_facts import ProgramRequest, StockFile
from service.requests.runs import ControlRequest, RunRequest
from stepnc_model.ap238.view import AimView
from stepnc_model.editing.user_data import fed_technologies
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.geometry import Polyline
from stepnc_model.entities.technology import MillingTechnology
from stepnc_model.entities.turning import TurningMachiningOperation, TurningTechnology
from stepnc_model.errors import SchemaError, Severity, StepNcError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.plausibility import proposal, refusal
from stepnc_model.programs.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.programs.technology import programmed
from stepnc_model.programs.tool import is_described, tool_name, tool_of
from stepnc_model.toolpath.task import drawn_stock

BAR = "DIAMETER,Z0,Z1"

MISFIT = 5.0
"""Ratio of a raw part to what the tools sweep from which it is doubtful in another unit."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Need:
    """Datum that a program lacks, with the option that gives it."""

    words: str
    """What is missing, and where."""
    option: str
    """Option with a name in capitals for the value."""
    error: StepNcError
    """Error that a command gives without it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ProgramNeeds:
    """Everything that a program lacks, and the command to complete."""

    needs: tuple[Need, ...]
    command: str

    @property
    def missing(self) -> tuple[str, ...]:
        """Sentences on the data that the user must give."""
        return tuple(dict.fromkeys(each.words for each in self.needs))

    def require_whole(self) -> None:
        """Raise an error that names all missing data.

        Raises
        ------
        StepNcError
            With everything that is missing, and the command to complete; for a single datum
            the error that names its place.
        """
        if len(self.missing) == 1:
            raise self.needs[0].error
        if self.missing:
            lacks = "; ".join(self.missing)
            raise StepNcError(f"missing: {lacks}; complete and run: {self.command}")


def needs_of(
    program: Program,
    request: ProgramRequest,
    *,
    file: str,
    tools: str = "",
) -> ProgramNeeds:
    """Find what a program lacks.

    Parameters
    ----------
    program : Program
        With all that the request gives.
    request : ProgramRequest
        Its options are those of the command; one for runs names material and machine, too.
    file : str
        File of the program as it is typed.
    tools : str
        Tool table that is given; empty: none.
    """
    material = str(getattr(request, "material", ""))
    machine = str(getattr(request, "machine", ""))
    steps = program.workingsteps
    found = program.file.findings + program.model.findings()
    if any(each.severity is Severity.ERROR for each in found):
        # What is damaged is told first: nothing that is given mends it.
        steps = ()
    needs = [*_units(program, steps), *_tools(program, steps), *_technologies(program, steps)]
    needs += _stock(program, steps)
    needs += _material(program, material) if steps else ()
    first = next(iter(program.workingsteps), None)
    is_lathe = first is not None and isinstance(first.operation, TurningMachiningOperation)
    options = list(dict.fromkeys(each.option for each in needs))
    if tools and "--tools TABLE" in options:
        options.remove("--tools TABLE")
    words = [
        f"stepnc {_verb(request)}",
        quote(file),
        *_options_of(request),
        *([f"--tools {quote(tools)}"] if tools else []),
        *([f"--material {quote(material)}"] if material else []),
        *options,
        f"--machine {quote(machine or (DEFAULT_LATHE if is_lathe else DEFAULT_MILL))}",
    ]
    return ProgramNeeds(needs=tuple(needs), command=" ".join(words))


def _verb(request: ProgramRequest) -> str:
    """Verb of the command that a request belongs to; advice for one of no run."""
    if isinstance(request, ControlRequest):
        return "control"
    return "simulate" if isinstance(request, RunRequest) else "optimise"


def _options_of(request: ProgramRequest) -> Iterator[str]:
    """Options of the request that say something of the program, as they were typed."""
    plain = ProgramRequest()
    if request.units != plain.units:
        yield f"--units {quote(request.units)}"
    if isinstance(request.stock, StockFile):
        yield f"--stock {quote(str(request.stock.path))}"
    elif request.stock:
        yield f"--stock={request.stock}"
    yield from (f"--set {quote(each)}" for each in request.given)
    yield from (f"--teeth {quote(each)}" for each in request.teeth)
    if request.feed:
        yield f"--feed {quote(request.feed)}"


def _units(program: Program, steps: tuple[ResolvedWorkingstep, ...]) -> Iterator[Need]:
    """Units of feeds and speeds, where the numbers cannot be in those of the program."""
    error = refusal(program, steps)
    if error is None:
        return
    if "--units" not in str(error):
        yield from _attribute(error)
        return
    names = [profile.name for profile in proposal(program, steps).profiles]
    yield Need(
        words=f"the units of feeds and speeds ({' or '.join(names)}): {error}",
        option=f"--units {names[0] if len(names) == 1 else 'UNITS'}",
        error=error,
    )


def _tools(program: Program, steps: tuple[ResolvedWorkingstep, ...]) -> Iterator[Need]:
    """Tools that the file only names, and those that lack a datum."""
    unknown: dict[str, SchemaError] = {}
    for ref in dict.fromkeys(step.tool_ref for step in steps):
        try:
            tool_of(program, ref)
        except SchemaError as error:
            if is_described(program, ref):
                yield from _attribute(error)
            else:
                unknown.setdefault(tool_name(program, ref), error)
    if unknown:
        names = ", ".join(f"'{name}'" for name in unknown)
        noun = "tools" if len(unknown) > 1 else "tool"
        yield Need(
            words=f"a table with {noun} {names}",
            option="--tools TABLE",
            error=next(iter(unknown.values())),
        )


def _technologies(program: Program, steps: tuple[ResolvedWorkingstep, ...]) -> Iterator[Need]:
    """Technologies without a feed or a speed."""
    users = {ref: step for step in reversed(steps) for ref in fed_technologies(program, step)}
    own = {step.technology_ref for step in steps}
    lacks_feed: list[tuple[Ref[Entity], SchemaError]] = []
    for ref in sorted(users, key=program.line):
        try:
            with program.using(users[ref].operation_ref):
                programmed(program, ref)
        except SchemaError as error:
            entity = program.get(ref)
            if error.attribute in FEEDS:
                lacks_feed.append((ref, error))
            if ref in own and (error.attribute not in FEEDS or not _has_speed(program, entity)):
                yield from _speed(program, ref, entity, error)
    if lacks_feed:
        places = ", ".join(_place(program, ref) for ref, _ in lacks_feed)
        is_turning = isinstance(program.get(lacks_feed[0][0]), TurningTechnology)
        yield Need(
            words=f"a feed ({places}), as {'0.2mm/rev' if is_turning else '240 in mm/min'}",
            option="--feed FEED",
            error=lacks_feed[0][1],
        )


def _has_speed(program: Program, entity: Entity) -> bool:
    """True if a technology turns the spindle."""
    if isinstance(entity, MillingTechnology):
        return bool(entity.spindle or entity.cutspeed)
    speed = getattr(entity, "spindle_speed", None)
    if speed is None:
        return not isinstance(entity, TurningTechnology)
    found = program.get(speed)
    return bool(getattr(found, "rot_speed", None) or getattr(found, "speed", None))


def _speed(
    program: Program, ref: Ref[Entity], entity: Entity, error: SchemaError
) -> Iterator[Need]:
    """Speed that a technology lacks, in the unit of the file; other data as they are."""
    if not isinstance(entity, MillingTechnology) or _has_speed(program, entity):
        yield from _attribute(error)
        return
    unit = speed_unit(program, ref)
    label = program.label(ref).partition(" ")[0]
    found = program.error("neither cutspeed nor spindle is given", ref, "spindle")
    yield Need(
        words=f"a spindle speed ({_place(program, ref)}) in {unit}, negative for clockwise",
        option=f'--set "{label}.spindle=SPEED"',
        error=found if error.attribute in FEEDS else error,
    )


def _place(program: Program, ref: Ref[Any]) -> str:
    """Place of an instance, as errors name it."""
    return f"line {program.line(ref)}: {program.label(ref)}"


def speed_unit(program: Program, ref: Ref[Any]) -> str:
    """Unit in which the spindle speed of a technology is given."""
    if isinstance(program.file, AimView):
        return program.file.number_unit(int(ref), "spindle") or "rev/s"
    return "rpm" if program.units_of(ref).spindle != 1.0 else "rev/s"


def _attribute(error: SchemaError) -> Iterator[Need]:
    """Attribute that an error names with the option that sets it."""
    text = str(error)
    _, found, option = text.rpartition("--set ")
    if found:
        yield Need(words=text.partition("; set it")[0], option=f"--set {option}", error=error)


def _stock(program: Program, steps: tuple[ResolvedWorkingstep, ...]) -> Iterator[Need]:
    """Raw part of paths that alone tell what is cut: none that fits them is known."""
    for step in {step.setup: step for step in steps if is_path_only(program, step)}.values():
        is_turning = isinstance(step.operation, TurningMachiningOperation)
        with suppress(SchemaError):
            drawn = None if program.stock else drawn_stock(program, step.setup)
            if program.stock is None and drawn is None and is_turning:
                yield Need(
                    words=f"the bar ({BAR} in mm)",
                    option=f"--stock={BAR}",
                    error=program.path_error(UNKNOWN_DEPTH, step.operation_ref),
                )
            if drawn is not None and not is_turning:
                yield from _misfit(program, step, drawn)


def _misfit(program: Program, step: ResolvedWorkingstep, drawn: Stock) -> Iterator[Need]:
    """Raw part in another unit than the paths, and far larger or smaller than these."""
    unit, swept = _foreign_unit(program), assumed_stock(program, step.setup)
    if not unit or swept is None:
        return
    sizes, spans = (
        [high - low for low, high in zip(each.low, each.high, strict=True)]
        for each in (drawn, swept)
    )
    ratios = [size / span for size, span in zip(sizes, spans, strict=True)]
    if sum(ratio > MISFIT or ratio < 1.0 / MISFIT for ratio in ratios) < len(ratios) - 1:
        return
    size = " x ".join(f"{value:.4g}" for value in sizes)
    swept_size = " x ".join(f"{value:.4g}" for value in spans)
    text = (
        f"the raw part is {size} mm, in {unit}, where the tools sweep {swept_size} mm, which "
        "are in another unit: --stock gives the true one"
    )
    numbers = ",".join(f"{value:.4g}" for value in (*swept.low, *swept.high))
    workpiece = program.workpiece()
    at = step.ref if workpiece is None else workpiece.its_bounding_geometry or step.ref
    yield Need(
        words=f"a raw part that fits ({text}, as the box that they sweep)",
        option=f"--stock={numbers}",
        error=program.error(text, at),
    )


def _foreign_unit(program: Program) -> str:
    """Unit of the raw part's sizes where it is not that of the paths' points; else empty."""
    view, workpiece = program.file, program.workpiece()
    if not isinstance(view, AimView) or workpiece is None:
        return ""
    body = workpiece.its_bounding_geometry
    path = next((ref for ref, _ in program.model.of_type(Polyline)), None)
    if body is None or path is None:
        return ""
    point = program.get(path).points[0]
    of_path = view.factor(int(point), "coordinates")
    names = {1.0: "millimetres", 25.4: "inches", 1000.0: "metres", 10.0: "centimetres"}
    found = view.factor(int(body), "x") or view.factor(int(body), "height")
    if found is None or of_path is None or isclose(found, of_path, rel_tol=1e-6):
        return ""
    return names.get(round(found, 6), f"a unit of {found:g} mm")


def _material(program: Program, name: str) -> Iterator[Need]:
    try:
        material_for(name, program)
    except StepNcError as error:
        if name:
            raise
        yield Need(
            words="material (`stepnc materials`)", option="--material MATERIAL", error=error
        )
