"""Two programs of the same part beside each other: paths, technologies, tools and findings.

``python -m benchmarks.twins [ONE OTHER]`` compares workingsteps of the same id (default:
EXAMPLE1 of ISO 14649-11 and its public AP238 form) and prints Markdown: the greatest distance
between the ends of their moves, then all data that differ, then the findings of both in the
words of ``stepnc check``, without lines and instance numbers.
"""

import argparse
import re
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from math import dist
from pathlib import Path

import stepnc
from benchmarks.corpus import CORPUS
from service.programs.reading import read_program
from stepnc_model.entities.entity import Entity
from stepnc_model.errors import SchemaError
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.technology import programmed
from stepnc_model.toolpath.generate import workingstep_path
from stepnc_model.toolpath.path import Move

ONE = CORPUS / "iso14649" / "EXAMPLE1_original.stp"
OTHER = CORPUS / "ap238" / "ap238_cc3_14649-11_example1.stpnc"

SAME = 1e-9
"""Distance and relative difference at which numbers are the same, mm."""

PLACE = re.compile(r"(line \d+: )?#\d+ ")
"""Where a finding is in its file."""

Difference = tuple[str, object, object]


def main(arguments: list[str] | None = None) -> None:
    """Print the comparison of two programs."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", nargs="*", type=Path, default=[ONE, OTHER], metavar="FILE")
    files = parser.parse_args(arguments).files
    if len(files) != len((ONE, OTHER)) or not all(file.is_file() for file in files):
        print("two programs are needed: nothing to print")
        return
    print("\n".join(comparison(*files)))


def comparison(one: Path, other: Path) -> Iterator[str]:
    """Lines of the comparison of two programs."""
    first, second = (read_program(file, units="iso") for file in (one, other))
    steps = {step.id: step for step in second.workingsteps}
    yield f"| workingstep | {one.name} | {other.name} | greatest distance mm |"
    yield "|---|---|---|---|"
    pairs = []
    for step in first.workingsteps:
        if step.id not in steps:
            yield f"| {step.id} | | missing | |"
            continue
        pairs.append((step, steps[step.id]))
        yield f"| {step.id} | {_distance(first, step, second, steps[step.id])} |"
    yield from ("", f"| data | {one.name} | {other.name} |", "|---|---|---|")
    seen: set[tuple[int, int]] = set()
    found: dict[str, Difference] = {}
    for mine, its in pairs:
        for name, left, right in _speeds(first, mine, second, its):
            found[name] = name, left, right
        for each in _differences(first, mine.operation_ref, second, its.operation_ref, seen):
            found.setdefault(f"{each}", each)
    for name, left, right in found.values():
        yield f"| {name} | {_shown(left)} | {_shown(right)} |"
    yield from ("", "| finding | in |", "|---|---|")
    told = [dict.fromkeys(_findings(file)) for file in (one, other)]
    for text in dict.fromkeys((*told[0], *told[1])):
        places = [file for file, texts in zip((one, other), told, strict=True) if text in texts]
        yield f"| {text} | {'both' if len(places) > 1 else places[0].name} |"


def _distance(
    one: Program, step: ResolvedWorkingstep, other: Program, twin: ResolvedWorkingstep
) -> str:
    """Number of moves of both paths, and the greatest distance between ends of moves."""
    ends = []
    for program, each in ((one, step), (other, twin)):
        try:
            path = workingstep_path(program, each)
        except SchemaError as error:
            return f"{error} | | "
        ends.append([path.start, *(move.end for move in path.steps if isinstance(move, Move))])
    counts = f"{len(ends[0]) - 1} moves | {len(ends[1]) - 1} moves"
    if len(ends[0]) != len(ends[1]):
        return f"{counts} | –"
    farthest = max(dist(*pair) for pair in zip(*ends, strict=True))
    return f"{counts} | {'same' if farthest <= SAME else f'{farthest:.4g}'}"


def _speeds(
    one: Program, step: ResolvedWorkingstep, other: Program, twin: ResolvedWorkingstep
) -> Iterator[Difference]:
    """Feed and speed of a workingstep in both programs, or why there is none."""
    mine, its = _technology(one, step), _technology(other, twin)
    if mine != its:
        yield f"{step.id}: feed mm/s, speed", mine, its


def _technology(program: Program, step: ResolvedWorkingstep) -> str:
    try:
        found = programmed(program, step.technology_ref)
    except SchemaError as error:
        return PLACE.sub("", str(error))
    return f"{found.feed.value:.6g}, {found.speed.value:.6g}"


def _differences(
    one: Program,
    mine: Ref[Entity],
    other: Program,
    its: Ref[Entity],
    seen: set[tuple[int, int]],
) -> Iterator[Difference]:
    """Attributes of two instances, and of those that they refer to, that differ."""
    if (int(mine), int(its)) in seen:
        return
    seen.add((int(mine), int(its)))
    first, second = one.model.entity(int(mine)), other.model.entity(int(its))
    if first is None or second is None or not is_dataclass(first):
        return
    if first.keyword != second.keyword:
        yield "entity", first.keyword, second.keyword
    for field in fields(first):
        if hasattr(second, field.name):
            values = getattr(first, field.name), getattr(second, field.name)
            name = f"{first.keyword}.{field.name}"
            yield from _values(one, values[0], other, values[1], name, seen)


def _values(
    one: Program,
    mine: object,
    other: Program,
    its: object,
    name: str,
    seen: set[tuple[int, int]],
) -> Iterator[Difference]:
    if isinstance(mine, Ref) and isinstance(its, Ref):
        yield from _differences(one, mine, other, its, seen)
    elif isinstance(mine, tuple) and isinstance(its, tuple) and len(mine) == len(its):
        for left, right in zip(mine, its, strict=True):
            yield from _values(one, left, other, right, name, seen)
    elif isinstance(mine, float) and isinstance(its, float):
        if abs(mine - its) > SAME * max(abs(mine), abs(its)):
            yield name, mine, its
    elif mine != its:
        yield name, mine, its


def _shown(value: object) -> str:
    if value is None or value == "":
        return "not given"
    if isinstance(value, tuple):
        return f"{len(value)} instances"
    return "given" if isinstance(value, Ref) else str(value)


def _findings(file: Path) -> Iterator[str]:
    """Findings and warnings of ``stepnc check``, without their places."""
    for each in stepnc.check(file).findings:
        yield PLACE.sub("", str(each))


if __name__ == "__main__":
    main()
