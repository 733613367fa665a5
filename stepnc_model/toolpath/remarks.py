"""Warnings about a program that concern all that is done with it, from one source.

Paths warn of what their generators assume: holes deeper than their features, security planes
that are moved. This module adds what shows in the program itself: a course of travel whose
placement is turned against the tool, features off the stock, a left-hand tool that is turned
clockwise, a stock that is not known or has the shape of a body. Workingsteps that cannot be
read are passed over here.
"""

from collections.abc import Iterable, Iterator

from stepnc_model.doubts import doubts
from stepnc_model.entities.enums import Hand
from stepnc_model.entities.profiles import LinearPath
from stepnc_model.errors import Finding, SchemaError, Severity
from stepnc_model.program import Program, ResolvedWorkingstep, Stock
from stepnc_model.technology import ProgrammedQuantity, programmed
from stepnc_model.tool import hand_of
from stepnc_model.toolpath.frame import feature_frame, frame_of
from stepnc_model.toolpath.left_out import SweptBox, swept_box
from stepnc_model.toolpath.path import ToolPath
from stepnc_model.toolpath.task import stock_of, unused_stock

COURSES = ("course_of_travel", "open_boundary", "profile_swept_shape")
"""Attributes of features that refer to a course of travel."""


def remarks(program: Program, paths: Iterable[ToolPath]) -> tuple[Finding, ...]:
    """Warnings about a program and its tool paths, each once, in program order.

    Parameters
    ----------
    program : Program
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
    return (*_of_stock(program), *found.values())


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
        yield program.finding(Severity.WARNING, text, step.features[0], "feature_placement")
