"""Cost or gain of each limit on the advice: the bracket, one limit after the other.

The first row has none of them: straight edges, the catalogue's feeds at any engagement, an end
mill that may bend 0.05 mm in a finish and 0.1 mm elsewhere, nominal k_c. Each row adds one.
The modes of the 20 mm end mill are an example (40 N/µm, ζ 0.04, 1200 Hz), no tap test.
"""

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

from optimiser import optimise as advising
from optimiser.advice import Plan
from optimiser.cuts.conditions import PermittedDeflection
from optimiser.modes import Free
from optimiser.planning.formulate import OptimisationTask
from simulator import library
from simulator.library import load_machine, match_material
from simulator.spec import (
    Machine,
    ModeDirection,
    ToolGrade,
    ToolKind,
    VibratingPart,
    VibrationMode,
)
from stepnc_model.entities.milling import BottomAndSideFinishMilling, SideFinishMilling
from stepnc_model.errors import Finding
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program, ResolvedWorkingstep

BRACKET = Path(__file__).parents[1] / "examples" / "parts" / "bracket.stpnc"
FINISHES = (SideFinishMilling, BottomAndSideFinishMilling)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """Limits that hold in a row."""

    name: str
    has_helix: bool = False
    has_tolerance: bool = False
    has_engagement: bool = False
    safety: float = 0.5
    has_modes: bool = False
    free: frozenset[Free] = frozenset({Free.FEED, Free.DEPTH})


def rows() -> Iterator[Row]:
    """Each with one limit more than the row before."""
    row = Row(name="none of them")
    for name, change in (
        ("helix of the edges", {"has_helix": True}),
        ("tolerances", {"has_tolerance": True}),
        ("chip load by engagement", {"has_engagement": True}),
        ("margin: k_c at its 90 % quantile", {"safety": 0.9}),
        ("stability of the 20 mm end mill", {"has_modes": True}),
        ("spindle speed free", {"free": frozenset(Free)}),
    ):
        yield row
        row = replace(row, name=f"+ {name}", **change)
    yield row


def main(arguments: list[str] | None = None) -> None:
    """Print times of the bracket on vmc15 in C45."""
    argparse.ArgumentParser(description=__doc__).parse_args(arguments)
    plans = [(row, plan_with(row)) for row in rows()]
    print(f"{'bracket.stpnc, TC, vmc15, C45':40}{'s':>9}{'change':>9}")
    print(f"{'as programmed':40}{plans[0][1].time_before:9.1f}")
    before = plans[0][1].time_before
    for row, plan in plans:
        time = plan.time_after
        told = f"{row.name:40}{time:9.1f}{time - before:+9.1f}"
        left = [each.workingstep.id for each in plan.advices if each.status == "infeasible"]
        print(told + (f"  infeasible: {', '.join(left)}" if left else ""))
        before = time


def plan_with(row: Row) -> Plan:
    """The bracket's plan under the limits of a row."""
    with _grades(row), _tolerances(row):
        return advising.optimise_program(
            Program(Part21File.from_bytes(BRACKET.read_bytes()), name="bracket"),
            machine=_machine(row),
            material=match_material(["C45"]),
            task=OptimisationTask(safety=row.safety, free=row.free),
        )


@contextmanager
def _grades(row: Row) -> Iterator[None]:
    """Tool grades without what a row does not have."""
    usual = library._grades

    def without(kind: ToolKind) -> tuple[ToolGrade, ...]:
        return tuple(
            replace(
                grade,
                helix_angle=grade.helix_angle if row.has_helix else 0.0,
                feed_window=grade.feed_window if row.has_engagement else None,
                min_feed=grade.min_feed if row.has_engagement else None,
                min_feed_ratio=grade.min_feed_ratio if row.has_engagement else None,
                parallel_land=grade.parallel_land if row.has_engagement else 0.0,
            )
            for grade in usual(kind)
        )

    with patch.object(library, "_grades", without):
        yield


@contextmanager
def _tolerances(row: Row) -> Iterator[None]:
    """Deflection by custom instead of by the drawing."""

    def by_custom(
        _program: Program, step: ResolvedWorkingstep
    ) -> tuple[PermittedDeflection, list[Finding]]:
        is_finish = isinstance(step.operation, FINISHES)
        return PermittedDeflection(value=0.05 if is_finish else 0.1), []

    if row.has_tolerance:
        yield
        return
    with patch.object(advising, "permitted_deflection", by_custom):
        yield


def _machine(row: Row) -> Machine:
    """The machining centre, with modes of one tool where a row has them."""
    machine = load_machine("vmc15")
    mode = VibrationMode(
        part=VibratingPart.TOOL,
        direction=ModeDirection.XY,
        natural_frequency=1200.0,
        damping_ratio=0.04,
        stiffness=40_000.0,
        tool_diameter=20.0,
        source="an example",
    )
    return replace(machine, modes=(mode,)) if row.has_modes else machine


if __name__ == "__main__":
    main()
