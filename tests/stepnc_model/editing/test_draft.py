"""Edits by attribute, in instances that are shared, short or carry a surplus parameter."""

from pathlib import Path

import pytest

from service.verbs.optimise.program import advise_program as optimise
from stepnc_model.editing import writeback
from stepnc_model.editing.draft import Draft
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from tests.asking import asked_advice

PARTS = Path(__file__).parents[3] / "examples" / "parts"
TECHNOLOGY = b"#41=MILLING_TECHNOLOGY($,.TCP.,0.583333333333333,$,0.05,.F.,.F.,.F.,$);"
ADAPTIVE = (
    b"#41=MILLING_TECHNOLOGY(#46,#47,.F.,.F.,.F.);\n"
    b"#46=CUTSPEED(.T.,0.583333333333333);\n#47=FEEDRATE_PER_TOOTH(.T.,0.05);"
)
STEP = b"#3=MACHINING_WORKINGSTEP('ROUGH THE FACE',#22,#30,#40,$);"


def paper002() -> bytes:
    return (PARTS / "paper002.stpnc").read_bytes()


def with_step(data: bytes, step: bytes, more: bytes = b"") -> bytes:
    data = data.replace(b"(#3),$,#20,$", b"(#3,#4),$,#20,$")
    return data.replace(STEP, STEP + b"\n" + step + more)


def optimised(data: bytes, folder: Path, profile: FileProfile, **options: object) -> bytes:
    source, output = folder / "in.stpnc", folder / "out.stpnc"
    source.write_bytes(data)
    request = asked_advice(
        file=source,
        output=output,
        profile=profile.value,
        machine="paper002",
        **options,  # type: ignore[arg-type]
    )
    optimise(*request)
    return output.read_bytes()


def feeds(data: bytes) -> dict[str, float]:
    program = Program(Part21File.from_bytes(data))
    return {
        step.id: programmed(program, step.technology_ref).feed.value
        for step in program.workingsteps
    }


def test_a_feed_inside_a_shared_technology_changes_for_one_operation_only(
    tmp_path: Path,
) -> None:
    second = b"\n#45=PLANE_ROUGH_MILLING($,$,'B',10.,$,#50,#41,#42,$,#43,#43,#44,3.,0.);"
    data = with_step(
        paper002().replace(TECHNOLOGY, ADAPTIVE),
        b"#4=MACHINING_WORKINGSTEP('AGAIN',#22,#30,#45,$);",
        second,
    )
    after = feeds(optimised(data, tmp_path, FileProfile.STANDARD, workingsteps=("#3",)))
    assert after["ROUGH THE FACE"] == pytest.approx(0.1171, rel=1e-3)
    assert after["AGAIN"] == pytest.approx(0.05)


@pytest.mark.parametrize("profile", list(FileProfile))
def test_one_operation_of_two_workingsteps_carries_one_record(
    profile: FileProfile, tmp_path: Path
) -> None:
    data = with_step(paper002(), b"#4=MACHINING_WORKINGSTEP('AGAIN',#22,#30,#40,$);")
    once = optimised(data, tmp_path, profile)
    assert list(writeback.records(Program(Part21File.from_bytes(once)))) == [40]
    assert optimised(once, tmp_path, profile) == once


@pytest.mark.parametrize("profile", list(FileProfile))
def test_an_operation_without_machine_functions_carries_a_record(
    profile: FileProfile, tmp_path: Path
) -> None:
    data = paper002().replace(b"#50,#41,#42,$,#43", b"#50,#41,$,$,#43")
    once = optimised(data, tmp_path, profile)
    assert list(writeback.records(Program(Part21File.from_bytes(once)))) == [40]
    assert optimised(once, tmp_path, profile) == once


@pytest.mark.parametrize("profile", list(FileProfile))
@pytest.mark.parametrize("end", [b"#44,3.);", b"#44);"])
def test_a_short_operation_is_filled_up(
    profile: FileProfile, end: bytes, tmp_path: Path
) -> None:
    data = paper002().replace(b"#44,3.,0.);", end)
    once = optimised(data, tmp_path, profile)
    assert len(writeback.records(Program(Part21File.from_bytes(once)))) == 1
    assert optimised(once, tmp_path, profile) == once


PATHS = (
    b"#60=TOOLPATH_LIST((#61));\n"
    b"#61=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,#62,$,$);\n"
    b"#62=POLYLINE('',(#63,#64,#63,#26));\n#63=CARTESIAN_POINT('',(0.,0.,0.));\n"
    b"#64=CARTESIAN_POINT('',(1.,0.,0.));\nENDSEC;\nEND"
)


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        (b"", [60, 61, 62, 63, 64]),
        (b"#65=POLYLINE('',(#63,#26));\n", [60, 61, 62, 64]),
        (b"#65=TOOLPATH_LIST((#61));\n", [60]),
        (b"#65=PLANE_FINISH_MILLING(#60);\n", []),
    ],
)
def test_what_others_refer_to_is_not_only_under_an_instance(
    more: bytes, expected: list[int]
) -> None:
    """The operation refers to #60; a placement refers to the point #26."""
    data = paper002().replace(b"#40=PLANE_ROUGH_MILLING($", b"#40=PLANE_ROUGH_MILLING(#60")
    data = data.replace(b"ENDSEC;\nEND", more + PATHS)
    draft = Draft(Program(Part21File.from_bytes(data)))
    keywords = frozenset({
        *("TOOLPATH_LIST", "CUTTER_LOCATION_TRAJECTORY", "POLYLINE", "CARTESIAN_POINT"),
    })
    assert sorted(draft.only_under(Ref(60), keywords)) == expected


def test_the_printed_place_of_a_record_is_left_and_depths_stay_in_theirs(
    tmp_path: Path,
) -> None:
    source = (Path(__file__).parents[2] / "data" / "fig11.stpnc").read_bytes()
    text = optimised(source, tmp_path, FileProfile.OPTIMISATION, material="paper002").decode()
    line = next(line for line in text.splitlines() if line.startswith("#20="))
    assert "#41, $,#60, #61, #42, 3., $, #" in line
