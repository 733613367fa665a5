"""Warnings about a program that concern all that is done with it, from one source.

Paths warn of what their generators assume: holes deeper than their features, security planes
that are moved. This module adds what shows in the program itself: a course of travel whose
placement is turned against the tool, features off the stock, a left-hand tool that is turned
clockwise, a stock that is not known or has the shape of a body. Workingsteps that cannot be
read are passed over here.

Doubts about what a program means: lengths in other units, ids that are there twice.

ISO 14649 knows millimetres only, so that its numbers are read as such. A file that says
otherwise, or whose tools fit their holes only in inches, is read the same way, and warned of.
"""

from collections.abc import Iterable, Iterator
from typing import Any

from stepnc_model.ap238.instances import Instances
from stepnc_model.ap238.quantity import MEASURES, Units, conversion
from stepnc_model.ap238.table import Kind
from stepnc_model.ap238.view import AimView
from stepnc_model.entities.enums import Hand
from stepnc_model.entities.executables import Parallel, Setup
from stepnc_model.entities.features import RoundHole
from stepnc_model.entities.milling import DrillingTypeOperation
from stepnc_model.entities.profiles import LinearPath
from stepnc_model.entities.turning import TurningMachiningOperation
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.programs.technology import ProgrammedQuantity, programmed
from stepnc_model.programs.tool import hand_of, tool_of
from stepnc_model.toolpath.frame import feature_frame, frame_of, surrounding_frame
from stepnc_model.toolpath.omissions import TOUCHING, SweptBox, swept_box
from stepnc_model.toolpath.path import ToolPath
from stepnc_model.toolpath.task import stock_of, unused_stock
from stepnc_model.units import mm_from_inches

CONTEXT = "GLOBAL_UNIT_ASSIGNED_CONTEXT"

ALIKE = 0.01
"""Relative difference up to which a tool in inches is taken for that of its hole."""


def doubts(program: Program) -> Iterator[Finding]:
    """Warnings about what a program may mean otherwise than it is read.

    Yields
    ------
    Finding
    """
    yield from _other_lengths(program)
    yield from _same_ids(program)
    yield from _simultaneous(program)
    for step in program.workingsteps:
        try:
            with program.using(step.operation_ref, step.tool_ref, *step.features):
                finding = _inch_tool(program, step)
        except SchemaError:
            continue
        if finding is not None:
            yield finding


def _other_lengths(program: Program) -> Iterator[Finding]:
    """Warn of units of length that no representation uses, but perhaps the whole file."""
    file = program.file
    if isinstance(file, AimView) or CONTEXT.encode() not in file.data:
        return
    instances = Instances(file)
    units = Units(instances)
    for context in instances.of_entity(CONTEXT):
        used = instances.referrers(context, "REPRESENTATION", "context_of_items")
        factor = conversion(units.length_in(context), MEASURES[Kind.LENGTH]).factor
        if used or factor == 1.0:
            continue
        text = (
            f"gives a unit of length of {factor:g} mm, but ISO 14649 has lengths in mm: the "
            "numbers of the program are read in mm"
        )
        yield program.finding(Severity.WARNING, text, Ref(context))


def _same_ids(program: Program) -> Iterator[Finding]:
    """Warn of different workingsteps with the same id."""
    first: dict[str, ResolvedWorkingstep] = {}
    for step in program.workingsteps:
        other = first.setdefault(step.id, step)
        if other.ref != step.ref:
            text = (
                f"'{step.id}' is also the id of {other.ref}: results that are listed by id do "
                "not tell them apart"
            )
            yield program.finding(Severity.WARNING, text, step.ref, "its_id")


def _simultaneous(program: Program) -> Iterator[Finding]:
    """Warn of branches that a control runs at the same time."""
    for executable in program.executables:
        entity = program.model.entity(int(executable.ref))
        if isinstance(entity, Parallel) and len(entity.branches) > 1 and not executable.is_open:
            text = "its branches run at the same time; here they run one after another"
            yield program.finding(Severity.WARNING, text, executable.ref, "branches")


def _inch_tool(program: Program, step: ResolvedWorkingstep) -> Finding | None:
    """Warn of a drill whose diameter is that of its hole in inches."""
    if not isinstance(step.operation, DrillingTypeOperation):
        return None
    diameter = tool_of(program, step.tool_ref).diameter
    for feature in map(program.get, step.features):
        if not isinstance(feature, RoundHole) or feature.diameter is None:
            continue
        hole = program.get(feature.diameter).theoretical_size
        if abs(mm_from_inches(diameter) - hole) <= ALIKE * hole:
            text = (
                f"diameter {diameter:g} mm: in inches it would be that of the hole, {hole:g} mm"
            )
            return program.finding(Severity.WARNING, text, step.tool_ref)
    return None


COURSES = ("course_of_travel", "open_boundary", "profile_swept_shape")
"""Attributes of features that refer to a course of travel."""


def remarks(program: Program, paths: Iterable[ToolPath]) -> tuple[Finding, ...]:
    """Warnings about a program and its tool paths, each once, in program order.

    Parameters
    ----------
    paths : iterable of ToolPath
        Paths of those workingsteps for which one can be made.

    Returns
    -------
    tuple of Finding
    """
    by_step = {int(path.workingstep): path for path in paths}
    found: dict[str, Finding] = {}
    for step in program.workingsteps:
        path = by_step.get(int(step.ref))
        for finding in (*_of_step(program, step), *_of_path(program, step, path)):
            found.setdefault(str(finding), finding)
    for finding in doubts(program):
        found.setdefault(str(finding), finding)
    return (*_of_stock(program), *_of_setups(program), *found.values())


def _of_setups(program: Program) -> Iterator[Finding]:
    """Warn of setups that stand turned on the machine: their z is the tool's axis."""
    milled = [
        step.setup
        for step in program.workingsteps
        if not isinstance(step.operation, TurningMachiningOperation)
    ]
    for ref in dict.fromkeys(milled):
        setup = None if ref is None else program.get(ref)
        if ref is None or not isinstance(setup, Setup) or setup.its_origin is None:
            continue
        try:
            with program.using(ref):
                frame = frame_of(program, setup.its_origin)
        except SchemaError:
            continue
        if frame.is_upright:
            continue
        x, y, z = frame.z
        text = (
            f"the setup stands turned on the machine, its z along ({x:.4g}, {y:.4g}, {z:.4g}): "
            "paths and NC code are those of the setup, with the tool along its z; index the "
            "table so before it runs"
        )
        yield program.finding(Severity.WARNING, text, ref, "its_origin")


def _of_stock(program: Program) -> Iterator[Finding]:
    """Say that a stock is not used, that none is known, or that it is that of a body."""
    is_said = False
    for step in program.workingsteps:
        try:
            with program.using(step.ref, step.setup):
                stock = stock_of(program, step.setup)
                unused = unused_stock(program, step.setup)
        except SchemaError:
            continue
        if unused is not None:
            yield unused
        if stock is not None and stock.is_around and not is_said:
            is_said = True
            yield Finding(severity=Severity.NOTE, message=_shape_words(stock))
        if stock is None:
            text = (
                "no stock is known (--stock names one): engagement is estimated, collisions "
                "are not found"
            )
            setup = step.ref if step.setup is None else step.setup
            at = setup if int(setup) in program.file else step.ref
            yield program.finding(Severity.WARNING, text, at)
            return


def _shape_words(stock: Stock) -> str:
    """Sentence that states which shape of a raw part is used for what."""
    kind = "box" if stock.radius is None else "bar"
    low, high = (",".join(f"{value:.4g}" for value in at) for at in (stock.low, stock.high))
    return (
        f"the raw part is a body: engagement, air and removal see its shape; tool paths are "
        f"made for the {kind} around it, {low} to {high} mm"
    )


def _of_step(program: Program, step: ResolvedWorkingstep) -> Iterator[Finding]:
    """Warnings about the tool and the features of a workingstep."""
    try:
        with program.using(step.operation_ref, step.tool_ref, step.technology_ref):
            speed = programmed(program, step.technology_ref).speed
            is_spindle = speed.quantity is ProgrammedQuantity.SPINDLE_SPEED
            is_turned_wrong = is_spindle and speed.scale < 0.0
            if is_turned_wrong and hand_of(program, step.tool_ref) is Hand.LEFT:
                text = "the spindle turns clockwise, but the tool is left-handed"
                yield program.finding(Severity.WARNING, text, step.technology_ref, "spindle")
    except SchemaError:
        pass
    for feature in step.features:
        try:
            with program.using(feature, step.setup):
                yield from _of_courses(program, step, int(feature))
        except SchemaError:
            continue


def _of_courses(program: Program, step: ResolvedWorkingstep, number: int) -> Iterator[Finding]:
    """Warnings about straight courses of travel that are placed across the tool's axis."""
    feature = next(ref for ref in step.features if int(ref) == number)
    entity = program.get(feature)
    for name in COURSES:
        ref = getattr(entity, name, None)
        path = None if ref is None else program.get(ref)
        if ref is None or not isinstance(path, LinearPath):
            continue
        frame = feature_frame(program, step.setup, feature)
        placed = frame.inner(frame_of(program, path.placement))
        if frame.is_upright and not placed.is_upright:
            x, y, z = placed.z
            text = (
                f"its axis ({x:.4g}, {y:.4g}, {z:.4g}) is not the tool's: used where its "
                "direction stays in the plane"
            )
            yield program.finding(Severity.WARNING, text, ref, "placement")


def _of_path(
    program: Program, step: ResolvedWorkingstep, path: ToolPath | None
) -> Iterator[Finding]:
    """Warnings of a path, and one if it lies off the stock."""
    if path is None:
        return
    for finding in path.findings:
        if finding.severity is Severity.WARNING:
            yield finding
    stock = stock_of(program, step.setup)
    box = None if path.is_turning else swept_box(program, path)
    if stock is None or box is None or not step.features:
        return
    if not box.overlaps(SweptBox(low=stock.low, high=stock.high)) and not any(
        "outside the stock" in finding.message for finding in path.findings
    ):
        text = "the feature lies outside the stock: its tool path meets none"
        if box.low[2] >= stock.high[2] - TOUCHING:
            text += _lower(program, step, stock.high[2])
        yield program.finding(Severity.WARNING, text, step.features[0], "feature_placement")


def _lower(program: Program, step: ResolvedWorkingstep, top: float) -> str:
    """Option that puts a feature above the stock on its top; empty where none does."""
    try:
        with program.using(step.features[0], step.setup):
            placement: Any = getattr(program.get(step.features[0]), "feature_placement", None)
            height = feature_frame(program, step.setup, step.features[0]).origin[2] - top
            at: Any = None if placement is None else program.get(placement)
            if at is None or height <= TOUCHING:
                return ""
            if not surrounding_frame(program, step.setup, step.features[0]).is_upright:
                return ""
            x, y, z = program.get(at.location).coordinates
    except SchemaError:
        return ""
    point = f"{at.location}.coordinates=({x!r},{y!r},{z - height!r})"
    return f'; --set "{point}" puts it on the stock, {height:.4g} mm lower'
