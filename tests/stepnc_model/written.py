"""Programs before and after writing, and what differs between them."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.editing import writeback
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.editing.record import AdviceRecord
from stepnc_model.editing.writeback import WorkingstepUpdate
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program, ResolvedWorkingstep
from stepnc_model.programs.technology import programmed
from tests.asking import asked_advice

PARTS = Path(__file__).parents[2] / "examples" / "parts"
EX1 = Path(__file__).parents[3] / "shared" / "corpus" / "iso14649" / "ex1.stp"

PARTS_NAMES = ("bracket", "paper002", "shaft")
PROFILES = tuple(FileProfile)
BOTH_WAYS = (PROFILES, PROFILES[::-1])

RECORD = AdviceRecord(
    mode="TC",
    id="OP",
    description="as fast as it goes",
    machine="vmc15",
    material="c45",
    generator="stepnc-optimiser",
    active_limit="motor power",
    number_of_passes=1,
    feed_per_tooth=0.1,
    axial_depth=3.0,
    machine_power=7.5,
    cutting_power=4.0,
    spindle_speed=-10.0,
    specific_cutting_resistance=2000.0,
    machining_time=30.0,
    motor_power=5.0,
    cutting_force=800.0,
    energy=1e5,
    programmed_cutspeed=0.58,
    programmed_feedrate_per_tooth=0.05,
)

OPERATION = (
    b"#40=PLANE_ROUGH_MILLING($,$,'ROUGH THE FACE',10.,$,#50,#41,#42,$,#43,#43,#44,3.,0.);"
)
SECOND = OPERATION.replace(b"#40=", b"#45=")
TECHNOLOGY = b"#41=MILLING_TECHNOLOGY($,.TCP.,0.583333333333333,$,0.05,.F.,.F.,.F.,$);"
ADAPTIVE = (
    b"#41=MILLING_TECHNOLOGY(#46,#47,.F.,.F.,.F.);\n"
    b"#46=CUTSPEED(.T.,0.58);\n#47=FEEDRATE_PER_TOOTH(.T.,0.05);"
)


def part(name: str) -> bytes:
    return (PARTS / f"{name}.stpnc").read_bytes()


def ex1() -> bytes:
    if not EX1.exists():
        pytest.skip("ex1.stp is not beside the project")
    return EX1.read_bytes()


def two_operations() -> bytes:
    """Paper 002's part, with a second operation that shares tool, technology, functions."""
    data = part("paper002")
    data = data.replace(b"(#3),$,#20,$", b"(#3,#4),$,#20,$")
    steps = b"#3=MACHINING_WORKINGSTEP('ROUGH THE FACE',#22,#30,#40,$);"
    data = data.replace(steps, steps + b"\n#4=MACHINING_WORKINGSTEP('AGAIN',#22,#30,#45,$);")
    return data.replace(OPERATION, OPERATION + b"\n" + SECOND)


def program_of(data: bytes) -> Program:
    return Program(Part21File.from_bytes(data))


@cache
def optimised(data: bytes, profile: FileProfile, *, mode: str = "TC") -> bytes:
    """What ``optimise`` makes of a file; many tests look at the same."""
    with TemporaryDirectory() as folder:
        source, output = Path(folder) / "in.stpnc", Path(folder) / "out.stpnc"
        source.write_bytes(data)
        optimise(*asked_advice(file=source, output=output, profile=profile.value, mode=mode))
        return output.read_bytes()


def converted(data: bytes, profile: FileProfile) -> bytes:
    return writeback.convert(program_of(data), profile)


def change_of(
    program: Program,
    step: ResolvedWorkingstep,
    *,
    feed: float | None = None,
    speed: float | None = None,
    depth: float | None = None,
) -> WorkingstepUpdate:
    conditions = programmed(program, step.technology_ref)
    return WorkingstepUpdate(
        workingstep=step,
        programmed=conditions,
        record=RECORD,
        feed=conditions.feed.in_file(conditions.feed.value) if feed is None else feed,
        speed=speed,
        depth=depth,
    )


def write_first(
    data: bytes, profile: FileProfile = FileProfile.STANDARD, **numbers: float
) -> bytes:
    """Change of the first workingstep alone."""
    program = program_of(data)
    change = change_of(program, program.workingsteps[0], **numbers)
    return writeback.write(program, [change], profile)


def instances(data: bytes) -> dict[int, bytes]:
    """Text of every instance."""
    file = Part21File.from_bytes(data)
    return {id: data[slice(*file.span(id))] for id in file.ids()}


def changed(before: bytes, after: bytes) -> dict[int, bytes]:
    """Instances of the input that have another text in the output."""
    old, new = instances(before), instances(after)
    return {id: new[id] for id, text in old.items() if new[id] != text}


def added(before: bytes, after: bytes) -> dict[int, bytes]:
    old = instances(before)
    return {id: text for id, text in instances(after).items() if id not in old}


def untouched_lines(before: bytes, after: bytes) -> list[bytes]:
    """Lines of the input that belong to no edited instance."""
    file = Part21File.from_bytes(before)
    spans = [file.span(id) for id in changed(before, after)]
    lines, place = [], 0
    for line in before.splitlines(keepends=True):
        end = place + len(line)
        if not any(start < end and place < stop for start, stop in spans):
            lines.append(line)
        place = end
    return lines


def stand_in_order(lines: list[bytes], data: bytes) -> bool:
    """Whether all lines are there, in order."""
    rest: Iterator[bytes] = iter(data.splitlines(keepends=True))
    return all(line in rest for line in lines)
