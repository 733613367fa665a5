"""Rude programs and files for ``toolpath``, ``post``, ``canonical`` and ``optimise --nc``.

Whatever is wrong: exit code 3, one line that says what and where, and nothing written.
"""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from service.cli.main import main, optimise_main
from service.progress import share_in
from tests.every_case import every_case
from tests.service.waiting import ended

PARTS = Path(__file__).parents[2] / "examples" / "parts"
BRACKET = (PARTS / "bracket.stpnc").read_text(encoding="ascii")
SHAFT = (PARTS / "shaft.stpnc").read_text(encoding="ascii")

USAGE, BAD_INPUT, INTERRUPTED = 2, 3, 130

# A shell that starts the tests in the background lets them ignore interrupts.
START = """
import signal
signal.signal(signal.SIGINT, signal.default_int_handler)
from service.cli.main import main
main()
"""
STEPNC = [sys.executable, "-c", START]

Refused = Callable[..., str]


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """The bracket in a folder of its own."""
    path = tmp_path / "part.stpnc"
    path.write_text(BRACKET, encoding="ascii")
    return path


@pytest.fixture
def refused(part: Path, capsys: pytest.CaptureFixture[str]) -> Refused:
    """Run a command that must refuse in one line and leave the folder alone; that line."""

    def run(*words: object, command: Callable[[list[str]], None] = main) -> str:
        before = inventory(part.parent)
        with pytest.raises(SystemExit) as stopped:
            command(list(map(str, words)))
        out, told = capsys.readouterr()
        assert stopped.value.code == BAD_INPUT, told
        assert inventory(part.parent) == before
        assert not out
        *_, last = told.splitlines()
        assert last.startswith("error: ")
        assert "Traceback" not in told
        assert not re.search(r"\b(nan|None|Error)\b", last)
        return last

    return run


def inventory(folder: Path) -> dict[str, bytes]:
    """Names and bytes of a folder, hidden files too."""
    return {
        path.name: path.read_bytes() if path.is_file() else b"" for path in folder.iterdir()
    }


def damaged(text: str, *changes: tuple[str, str]) -> str:
    """A program with changes."""
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


def spline(degree: int, multiplicities: str, knots: str) -> tuple[str, str]:
    """The wall of the open pocket as a B-spline."""
    return (
        "POLYLINE('WALL',(#500,#181,#182,#183))",
        f"B_SPLINE_CURVE_WITH_KNOTS('WALL',{degree},(#500,#181,#182,#183),.UNSPECIFIED.,.F.,"
        f".F.,{multiplicities},{knots},.UNSPECIFIED.)",
    )


def instead(executable: str) -> tuple[str, str]:
    """Another executable in the place of the stop."""
    return "OPTIONAL_STOP('LOOK AT THE CLAMPING')", executable


POCKET = "'ROUGH POCKET',#43,#140,#206,$"
DEPTH = "'',(0.,0.,-12.)"
CUT = "4.,6.,0.3,0.2);"
CORNER = "#551=CIRCLE('',#561,10.)"
FEED = "#304=MILLING_TECHNOLOGY(0.0064,.TCP.,$,-40."


@every_case(
    ("change", "words"),
    [
        (("#422=MILLING_TOOL_DIMENSION(12.", "#422=MILLING_TOOL_DIMENSION(14."), "#130 SLOT"),
        (
            ("#432=MILLING_TOOL_DIMENSION(10.", "#432=MILLING_TOOL_DIMENSION(70."),
            "does not fit",
        ),
        (("#192=TOLERANCED_LENGTH_MEASURE(16.", "#192=TOLERANCED_LENGTH_MEASURE(50."), "#190"),
        (
            ("#181,#182,#183)", "#181,#182,#183,#500)"),
            "boundary is closed",
        ),
        (("#527,#528)", "#527)"), "does not close"),
        (("(#521,#522,#523,", "(#521,#522,"), "do not join"),
        ((DEPTH, "'',(0.,0.,-60.)"), "below the workpiece"),
        ((DEPTH, "'',(0.,0.,0.)"), "depth 0 mm"),
        (
            ("#141,#143,(#190)", "#141,$,(#190)"),
            "#140 CLOSED_POCKET.depth: the feature has no depth",
        ),
        (("'ROUGH POCKET',10.", "'ROUGH POCKET',-10."), "-10 mm: the retract plane"),
        (
            ("'DRILL HOLE 1',5.", "'DRILL HOLE 1',-50."),
            "-50 mm: the retract",
        ),
        ((CUT, "4.,6.,0.3,20.);"), "nothing is removed"),
        ((CUT, "4.,6.,-1.,0.);"), "-1 mm: an allowance"),
        ((CUT, "0.,6.,0.3,0.2);"), "depth of cut"),
        ((CUT, "4.,0.,0.3,0.2);"), "width of cut"),
        ((CUT, "1.E-9,6.,0.3,0.2);"), "1e-09 mm"),
        ((CUT, "4.,1.E-9,0.3,0.2);"), "1e-09 mm"),
        (("(0.,0.,50.)", "(0.,0.,1.E300)"), "beyond 100000 mm"),
        (("#45=CARTESIAN_POINT('',(0.,0.,50.))", "#45=$"), "#45"),
        (instead("IF_STATEMENT('IF',$,#5,$)"), "#7 IF_STATEMENT"),
        (instead("WHILE_STATEMENT('W',$,#5)"), "#7 WHILE_STATEMENT"),
        (instead("WAIT_FOR_MARK('P',$)"), "#7 WAIT_FOR_MARK"),
        (instead("SELECTIVE('S',(#5,#6))"), "#7 SELECTIVE"),
        (instead("ASSIGNMENT('A',$,$)"), "#7 ASSIGNMENT"),
        (instead("TOUCH_PROBING('T',$,$)"), "#7 TOUCH_PROBING"),
        (("(#3,#7,#4,#5,#6)", "()"), "nothing to machine"),
        (("(#3,#7,#4,#5,#6)", "(#7,#7)"), "nothing to machine"),
        (
            ("(#3,#7,#4,#5,#6)", "(#3,#2)"),
            "structure contains itself",
        ),
        (("#142,#501,#502)", "#142,#502,#501)"), "axis (1, 0, 0)"),
        (("#142,#501,#502)", "#142,#501,#501)"), "ref_direction is parallel"),
        (("#142,#501,#502)", "#142,#45,#502)"), "#45"),
        (("#162,#501,#502)", "#162,#502,#501)"), "axis (1, 0, 0)"),
        ((CORNER, "#551=CIRCLE('',#561,9.)"), "off its circle"),
        (("(.CONTINUOUS.,.T.,#531)", "(.CONTINUOUS.,.T.,#520)"), "contains itself"),
        (("(.CONTINUOUS.,.T.,#531)", "(.CONTINUOUS.,.T.,$)"), "#521 COMPOSITE_CURVE_SEGMENT"),
        (spline(3, "(4,4)", "(1.,0.)"), "the knots decrease"),
        (spline(3, "(4,3)", "(0.,1.)"), "7 knots"),
        (spline(-3, "(4,4)", "(0.,1.)"), "degree -3"),
        (spline(3, "(4,1000000000)", "(0.,1.)"), "multiplicity 1000000000"),
        (spline(3, "(4,4)", "(0.,0.)"), "has no length"),
        ((POCKET, "'ROUGH POCKET',#43,#999,#206,$"), "#999: is referenced"),
        (
            (POCKET, "'ROUGH POCKET',#43,$,#206,$"),
            "#16 MACHINING_WORKINGSTEP.its_feature",
        ),
        (
            (POCKET, "'ROUGH POCKET',#44,#140,#206,$"),
            "#44 AXIS2_PLACEMENT_3D is referenced",
        ),
        (("END MILL 12MM',#421", "END MILL 12MM',#430"), "#430 MILLING_CUTTING_TOOL"),
        (("(#403),110.", "(#45),110."), "#45 CARTESIAN_POINT is referenced"),
        (("$,#40,$);\n#3", "$,#41,$);\n#3"), "not a setup"),
        (("(#30),$,$,$)", "(#41),$,$,$)"), "not a workpiece"),
    ],
)
def test_a_program_that_cannot_be_machined_is_refused_by_both_verbs(
    part: Path, refused: Refused, change: tuple[str, str], words: str
) -> None:
    part.write_text(damaged(BRACKET, change), encoding="ascii")
    told = refused("toolpath", part)
    assert words in told
    assert refused("post", part, "--control", "fanuc") == told


@every_case(
    ("change", "words"),
    [
        ((FEED, FEED.replace("0.0064", "$")), "feedrate: neither"),
        ((FEED, FEED.replace("0.0064", "-1.")), "feed -1"),
        ((FEED, FEED.replace("0.0064", "1.E300")), "exceeds the radius"),
        ((FEED, FEED.replace("0.0064", "1.E-300")), "is below 0.0005 mm"),
        ((FEED, FEED.replace("-40.", "$")), "#304 MILLING_TECHNOLOGY"),
        ((FEED, FEED.replace("-40.", "0.")), "is not valid"),
        ((FEED, FEED.replace("-40.", "1.E300")), "exceeds 300 rev/s"),
    ],
)
def test_a_feed_or_speed_that_no_control_runs_is_not_written(
    part: Path, refused: Refused, change: tuple[str, str], words: str
) -> None:
    part.write_text(damaged(BRACKET, change), encoding="ascii")
    assert words in refused("post", part, "--control", "linuxcnc")


@every_case(
    ("change", "words"),
    [
        (("MEASURE(54.", "MEASURE(80."), "radius of 40 mm"),
        (
            ("(0.,0.,-80.));\n#123", "(0.,0.,-180.));\n#123"),
            "from -150 to 2 mm",
        ),
        (("(0.,0.,-80.));\n#123", "(5.,0.,-80.));\n#123"), "off the spindle axis"),
        (("#122,#501,#502", "#122,#502,#501"), "not parallel"),
        (("#134=TOLERANCED_LENGTH_MEASURE(4.", "#134=TOLERANCED_LENGTH_MEASURE(1."), "3 mm"),
        (("#505,12.5,#133", "#505,40.,#133"), "outside the stock"),
        (("#505,12.5,#133", "#505,$,#133"), "#130 GROOVE.radius"),
        (("(#113,#114,#115,#116,#117,#118,#119)", "(#113)"), "has no length"),
        ((".T.,(2.)", ".T.,(0.)"), "cutting depth 0 mm"),
        ((".T.,(2.)", ".T.,(1.E-9)"), "2000 passes"),
        (
            ("#34,152.,30.)", "#34,152.,1.E300)"),
            "stock is larger",
        ),
        (("#34,152.,30.)", "#34,$,30.)"), "CYLINDER.height: $"),
        (("ROUNDED_CORNER(0.8)", "ROUNDED_CORNER(-0.8)"), "radius -0.8 mm"),
    ],
)
def test_a_turned_part_that_cannot_be_is_refused(
    part: Path, refused: Refused, change: tuple[str, str], words: str
) -> None:
    part.write_text(damaged(SHAFT, change), encoding="ascii")
    assert words in refused("toolpath", part)


def test_a_speed_of_the_wrong_kind_is_named(part: Path, refused: Refused) -> None:
    part.write_text(damaged(SHAFT, ("#312,0.06", "#45,0.06")), encoding="ascii")
    told = refused("post", part, "--control", "fanuc")
    assert "#45 CARTESIAN_POINT" in told


def test_milling_and_turning_do_not_go_into_one_program(part: Path, refused: Refused) -> None:
    data = SHAFT.split("DATA;")[1].split("ENDSEC;")[0]
    moved = re.sub(r"#(\d+)", lambda found: f"#{int(found[1]) + 1000}", data)
    turned = "\n".join(line for line in moved.splitlines() if "=PROJECT(" not in line)
    text = damaged(BRACKET, ("(#3,#7,#4,#5,#6)", "(#3,#1013)"), ("ENDSEC;\nEND", "@END"))
    stock = ("#33=BLOCK('STOCK',#34,156.,96.,42.)", "#33=$")
    text = damaged(text, ("@END", f"{turned}\nENDSEC;\nEND"), stock)
    part.write_text(text, encoding="ascii")
    refused("post", part, "--control", "linuxcnc")


@pytest.mark.parametrize("verb", ["toolpath", "post"])
def test_keeping_on_makes_all_others_and_says_so(
    part: Path, capsys: pytest.CaptureFixture[str], verb: str
) -> None:
    part.write_text(damaged(BRACKET, (DEPTH, "'',(0.,0.,0.)")), encoding="ascii")
    options = ["--control", "fanuc"] if verb == "post" else []
    with pytest.raises(SystemExit) as stopped:
        main([verb, str(part), "--keep-going", *options])
    out, told = capsys.readouterr()
    assert stopped.value.code == BAD_INPUT
    assert told.count("left out: ") == 2
    made = part.with_suffix(".nc").read_text(encoding="ascii") if verb == "post" else out
    assert "DRILL HOLE 2" in made
    missing = "THIS WORKINGSTEP IS LEFT OUT" if verb == "post" else "left_out"
    assert made.count(missing) == 2


# ------------------------------------------------------------------ files and disks


def test_what_is_no_program_is_refused(part: Path, refused: Refused) -> None:
    junk = part.with_name("junk")
    for data in (b"", bytes(range(256)) * 20):
        junk.write_bytes(data)
        assert "line 1" in refused("post", junk, "--control", "fanuc")
    assert "is a folder" in refused("post", part.parent, "--control", "fanuc")
    assert "is not a file" in refused("post", ".", "--control", "fanuc")
    assert "No such file" in refused("post", "nowhere", "--control", "fanuc")
    assert "unknown control 'x'" in refused("post", part, "--control", "x")


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("part.stpnc", "name another file"),
        ("link", "name another file"),
        ("nowhere/out.nc", "the folder does not exist"),
        (".", "is not a regular file"),
        ("/dev/full", "is not a regular file"),
    ],
)
def test_an_output_that_cannot_be_is_refused(
    part: Path, refused: Refused, output: str, words: str
) -> None:
    (part.parent / "link").symlink_to(part)
    assert words in refused("post", part, "--control", "fanuc", "-o", part.parent / output)


def test_a_failure_leaves_the_old_output(part: Path, refused: Refused) -> None:
    part.with_suffix(".nc").write_text("old", encoding="ascii")
    part.write_text(
        damaged(BRACKET, (FEED, FEED.replace("0.0064", "1.E300"))), encoding="ascii"
    )
    refused("post", part, "--control", "fanuc")


def test_code_that_optimise_cannot_write_leaves_the_program_unwritten(
    part: Path, refused: Refused
) -> None:
    part.write_text(SHAFT, encoding="ascii")
    told = refused(part, "--nc", "heidenhain", command=optimise_main)
    assert "Klartext is written for mills only" in told
    assert "unknown control 'x'" in refused(part, "--nc", "x", command=optimise_main)


def test_an_interrupt_ends_a_long_program_without_a_file(part: Path) -> None:
    numbers = range(10_000, 13_000)
    steps = "".join(f"#{n}=MACHINING_WORKINGSTEP('WS {n}',#43,#140,#206,$);\n" for n in numbers)
    names = ",".join(f"#{n}" for n in numbers)
    text = damaged(
        BRACKET, ("(#3,#7,#4,#5,#6)", f"({names})"), ("ENDSEC;\nEND", f"{steps}ENDSEC;\nEND")
    )
    part.write_text(text, encoding="ascii")
    before = inventory(part.parent)
    with subprocess.Popen(
        [*STEPNC, "post", str(part), "--control", "fanuc"],
        stderr=subprocess.PIPE,
        text=True,
    ) as running:
        assert running.stderr is not None
        assert "of 3000 workingsteps" in running.stderr.readline()
        running.send_signal(signal.SIGINT)
        assert running.stderr.read().splitlines()[-1] == "interrupted"
        assert ended(running) == INTERRUPTED
    assert inventory(part.parent) == before


def without_progress(said: bytes) -> list[bytes]:
    """A slow machine also says how far it is, and every command what it warns of."""
    return [
        line
        for line in said.splitlines()
        if share_in(line.decode()) is None and not line.startswith(b"warning: ")
    ]


def test_a_reader_that_leaves_is_no_failure(part: Path) -> None:
    main_text = [*STEPNC, "toolpath", str(part), "--json"]
    with subprocess.Popen(main_text, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        assert running.stdout is not None
        assert running.stderr is not None
        running.stdout.read(1)
        running.stdout.close()
        assert without_progress(running.stderr.read()) == []
        assert ended(running) == 0


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no /dev/full")
def test_a_full_disk_behind_stdout_is_said(part: Path) -> None:
    with open("/dev/full", "wb") as full:
        done = subprocess.run(
            [*STEPNC, "toolpath", str(part), "--json"],
            stdout=full,
            stderr=subprocess.PIPE,
            check=False,
        )
    assert done.returncode == BAD_INPUT
    assert without_progress(done.stderr) == [b"error: stdout: No space left on device"]
