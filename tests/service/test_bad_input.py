"""Whatever is wrong: an exit code, one line that says what and where, and nothing written."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from service.cli.main import main, optimise_main
from tests.every_case import every_case
from tests.full_disk import files_of_at_most
from tests.rights import Capability, without

ROOT = Path(__file__).parents[2]
PARTS = ROOT / "examples" / "parts"
PAPER = (PARTS / "paper002.stpnc").read_text(encoding="ascii")
VMC = (ROOT / "simulator" / "data" / "machines" / "vmc15.toml").read_text(encoding="utf-8")
CORPUS = ROOT.parent / "shared" / "corpus"

USAGE, BAD_INPUT = 2, 3

MEGABYTES = 20

HEAD = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n"


@dataclass(frozen=True, slots=True, kw_only=True)
class Answer:
    """What a command did."""

    code: object
    out: str
    error: str
    """last line on stderr"""


Optimise = Callable[..., Answer]


@pytest.fixture
def part(tmp_path: Path) -> Path:
    """The paper's program in a folder of its own."""
    folder = tmp_path / "folder"
    folder.mkdir()
    path = folder / "part.stpnc"
    path.write_text(PAPER, encoding="ascii")
    return path


@pytest.fixture
def refused(part: Path, capsys: pytest.CaptureFixture[str]) -> Optimise:
    """Run ``optimise``, which must refuse, say so in one line, and leave the folder alone."""

    def run(*options: object, code: int = BAD_INPUT, file: object = part) -> Answer:
        before = inventory(part.parent)
        with pytest.raises(SystemExit) as stopped:
            optimise_main([str(file), *map(str, options)])
        out, told = capsys.readouterr()
        *earlier, last = told.splitlines()
        assert stopped.value.code == code, told
        assert inventory(part.parent) == before
        assert "Traceback" not in told
        assert not out
        if code == BAD_INPUT:
            assert last.startswith("error: ")
            # What takes long may say so.
            said = re.compile(r"material: |compiling |\d+ of \d+ workingsteps")
            assert all(said.match(line) for line in earlier)
        return Answer(code=stopped.value.code, out=out, error=last)

    return run


def inventory(folder: Path) -> dict[str, bytes]:
    """Names and bytes of a folder, hidden files too."""
    return {
        path.name: path.read_bytes() if path.is_file() else b"" for path in folder.iterdir()
    }


def damaged(old: str, new: str) -> str:
    """The paper's program with one change."""
    assert PAPER.count(old) == 1, old
    return PAPER.replace(old, new)


# ------------------------------------------------------------------------- the text


@every_case(
    ("text", "words"),
    [
        ("", "line 1, column 1: the file is empty"),
        (" \r\n\n", "line 1, column 1: the file is empty"),
        ("a text\n", "'a text' found"),
        ("{}", "not an ISO 10303-21 file"),
        (PAPER[: PAPER.index("'ROUGH THE FACE',10.") + 4], "line 53, column 29"),
        (PAPER[: PAPER.index("#50,#41,#42")], "line 53, column 1"),
        (PAPER[: PAPER.index("#50=MILLING")], "#50: is referenced"),
        (damaged("#43=PLUNGE", "#44=PLUNGE"), "#44 is defined twice"),
        (HEAD + "ENDSEC;\nEND-ISO-10303-21;\n", "no PROJECT"),
    ],
)
def test_a_text_that_is_no_program_is_refused_with_its_line(
    part: Path, refused: Optimise, text: str, words: str
) -> None:
    part.write_text(text, encoding="ascii")
    assert words in refused().error


def test_bytes_of_another_encoding_are_refused(part: Path, refused: Optimise) -> None:
    part.write_bytes(PAPER.encode("utf-16"))
    assert "not an ISO 10303-21 file" in refused().error


@pytest.mark.parametrize("start", ["", HEAD + "#1=PROJECT("])
def test_20_megabytes_of_brackets_are_refused(
    part: Path, refused: Optimise, start: str
) -> None:
    part.write_text(start + "(" * (MEGABYTES * 1_000_000), encoding="ascii")
    assert len(refused().error) < 200


def test_lists_that_nest_without_end_are_refused(part: Path, refused: Optimise) -> None:
    nested = "(" * 200_000 + "#3" + ")" * 200_000
    part.write_text(damaged("(#3),$,#20", f"{nested},$,#20"), encoding="ascii")
    assert "#2 WORKPLAN: lists nested deeper than 500" in refused().error


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("#3=MACHINING", "#" + "9" * 5_000 + "=MACHINING", "line 18, column 1: instance name"),
        ("#52,4,", "#52," + "9" * 5_000 + ",", "#51 TAPERED_ENDMILL: an integer of 5000"),
    ],
)
def test_numbers_without_end_are_refused(
    part: Path, refused: Optimise, old: str, new: str, words: str
) -> None:
    part.write_text(damaged(old, new), encoding="ascii")
    answer = refused()
    assert words in answer.error
    assert len(answer.error) < 200


# ------------------------------------------------------------------------ instances


@every_case(
    ("old", "new", "words"),
    [
        ("#50,#41,#42", "#950,#41,#42", "#950: is referenced"),
        ("#50,#41,#42", "#50,#941,#42", "#941: is referenced"),
        (
            "#50,#41,#42",
            "$,#41,#42",
            "#40 PLANE_ROUGH_MILLING.its_tool",
        ),
        (
            "#50,#41,#42",
            "#50,$,#42",
            "#40 PLANE_ROUGH_MILLING.its_technology",
        ),
        (
            "#50,#41,#42",
            "#41,#41,#42",
            "#41 MILLING_TECHNOLOGY is referenced",
        ),
        (
            "#50,#41,#42",
            "#50,#50,#42",
            "#50 MILLING_CUTTING_TOOL is referenced",
        ),
        (
            "(#3),$,#20",
            "(#3,#2),$,#20",
            "contains itself",
        ),
        (
            "(#3),$,#20,$);",
            "(#3,#300),$,#20,$);\n#300=WORKPLAN('B',(#2),$,$,$);",
            "contains itself",
        ),
        ("(#3),$,#20", "(),$,#20", "no machining workingstep"),
        ("(#3),$,#20", "(#43),$,#20", "no machining workingstep"),
        ("#22,#30,#40,$)", "#22,#30,#3,$)", "#3 MACHINING_WORKINGSTEP"),
        ("'MILL 18MM',#51", "'MILL 18MM',#50", "its_tool_body: #50 MILLING_CUTTING_TOOL"),
        (
            "#1=PROJECT('PAPER 002',#2,",
            "#1=PROJECT('PAPER 002',$,",
            "#1 PROJECT.main_workplan",
        ),
        (
            "#2=WORKPLAN('MAIN WORKPLAN',(#3),$,#20,$);",
            "",
            "#2: is referenced",
        ),
    ],
)
def test_references_that_lead_nowhere_or_in_a_circle_are_named(
    part: Path, refused: Optimise, old: str, new: str, words: str
) -> None:
    part.write_text(damaged(old, new), encoding="ascii")
    assert words in refused().error


# -------------------------------------------------------------------------- numbers


@every_case(
    ("number", "words"),
    [
        ("0.", "feed per tooth 0"),
        ("-0.05", "feed per tooth -0.05"),
        ("1.E-400", "feed per tooth 0"),
        ("NAN", "NAN"),
        ("1E400", "inf is not a finite number"),
        ("-1.E400", "-inf is not a finite number"),
        ("'0.05'", "'0.05'"),
        ("(0.05)", "a list where"),
        ("#50", "#50 where"),
        ("10.", "exceeds the radius"),
        ("1.E-320", "below 0.0005 mm"),
    ],
)
def test_a_feed_that_cannot_be_is_refused(
    part: Path, refused: Optimise, number: str, words: str
) -> None:
    part.write_text(damaged("$,0.05,.F.", f"$,{number},.F."), encoding="ascii")
    answer = refused()
    assert words in answer.error
    assert "line 54: #41 MILLING_TECHNOLOGY" in answer.error


@every_case(
    ("old", "new", "words"),
    [
        (".TCP.,0.583333333333333", ".TCP.,0.", "#41 MILLING_TECHNOLOGY.cutspeed: cutting sp"),
        (".TCP.,0.583333333333333", ".TCP.,-0.5", "cutting speed -0.5"),
        (".TCP.,0.583333333333333", ".TCP.,1.E400", "cutspeed: inf"),
        (".TCP.,0.583333333333333", ".TCP.,35.", "exceeds 25 m/s"),
        ("DIMENSION(18.", "DIMENSION(0.", "#52 MILLING_TOOL_DIMENSION"),
        ("DIMENSION(18.", "DIMENSION(-18.", "diameter -18.0 mm"),
        ("DIMENSION(18.", "DIMENSION(1.E400", "diameter: inf"),
        ("DIMENSION(18.", "DIMENSION($", "#52 MILLING_TOOL_DIMENSION"),
        ("#52,4,", "#52,0,", "number_of_teeth: 0"),
        ("#52,4,", "#52,-4,", "number_of_teeth: -4"),
        ("#52,4,", "#52,4.5,", "number_of_teeth: 4.5"),
        ("#44,3.,0.)", "#44,1.E400,0.)", "axial_cutting_depth: inf"),
        ("LENGTH_MEASURE(300.", "LENGTH_MEASURE(0.", "#37 TOLERANCED_LENGTH_MEASURE"),
        ("LENGTH_MEASURE(300.", "LENGTH_MEASURE(-300.", "-300 mm"),
        ("LENGTH',18.", "LENGTH',-18.", "#93 NUMERIC_PARAMETER"),
    ],
)
def test_a_size_or_speed_that_cannot_be_is_refused_with_entity_and_value(
    part: Path, refused: Optimise, old: str, new: str, words: str
) -> None:
    part.write_text(damaged(old, new), encoding="ascii")
    assert words in refused().error


def test_numbers_of_another_unit_profile_are_refused_and_the_profile_named(
    part: Path, refused: Optimise
) -> None:
    """618.9 rpm and 0.05 mm/tooth in the attributes of m/s and rev/s."""
    wrong = damaged("($,.TCP.,0.583333333333333,$,0.05,", "(0.05,.TCP.,$,-618.9,$,")
    part.write_text(wrong, encoding="ascii")
    answer = refused()
    assert "line 54: #41 MILLING_TECHNOLOGY.spindle" in answer.error
    assert "spindle 618.9 rev/s exceeds 300 rev/s" in answer.error
    assert "--units rpm-mmtooth" in answer.error


# ---------------------------------------------------------------- words and names


@every_case(
    ("options", "words"),
    [
        (("--mode", "FAST"), "mode 'FAST'"),
        (("--units", "imperial"), "units 'imperial'"),
        (("--profile", "mine"), "profile 'mine'"),
        (("--free", "width"), "free 'width'"),
        (("--free", "feed,,depth"), "unknown free ''"),
        (("--material", "unobtanium"), "material 'unobtanium'"),
        (("--material", "nowhere.toml"), "nowhere.toml"),
        (("--machine", "vmc51"), "unknown machine 'vmc51'; known: vmc15"),
        (("--machine", "nowhere.toml"), "nowhere.toml: cannot be read"),
        (("--machine", "nowhere.xml"), "nowhere.xml: cannot be read"),
        (("--roughness", "0"), "roughness 0 µm"),
        (("--roughness", "-1.6"), "roughness -1.6 µm"),
        (("--roughness", "nan"), "roughness nan µm"),
        (("--roughness", "1e400"), "roughness inf µm: it must be above 0 to 1000 µm"),
        (("--workingstep", "nope"), "no workingstep 'nope'; known: 'ROUGH THE FACE' (#3)"),
        (("--workingstep", "#40"), "workingstep '#40'"),
        (("--in-place", "-o", "x"), "exclude each other"),
    ],
)
def test_a_word_that_is_not_known_is_refused_with_those_that_are(
    refused: Optimise, options: tuple[str, ...], words: str
) -> None:
    assert words in refused(*options).error


@pytest.mark.parametrize(
    "options", [("--bogus",), ("--mode",), ("--roughness", "smooth"), ("two", "files")]
)
def test_a_command_line_that_makes_no_sense_is_wrong_usage(
    refused: Optimise, options: tuple[str, ...]
) -> None:
    assert refused(*options, code=USAGE).error.startswith("optimise: error: ")


def test_a_command_without_a_file_is_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    for command, arguments in ((optimise_main, []), (main, []), (main, ["bogus"])):
        with pytest.raises(SystemExit) as stopped:
            command(arguments)
        assert stopped.value.code == USAGE
    assert "Traceback" not in capsys.readouterr().err


def test_a_program_that_names_no_material_asks_for_one(part: Path, refused: Optimise) -> None:
    part.write_text(damaged("'BAR',#11,", "'BAR',$,"), encoding="ascii")
    assert "--material" in refused().error


def test_a_material_that_nobody_knows_is_refused_with_near_names(
    part: Path, refused: Optimise
) -> None:
    unknown = damaged(
        "MATERIAL('paper002','St37, constant specific cutting resistance of 1000 N/mm2'",
        "MATERIAL('unobtanium','mithril'",
    )
    part.write_text(unknown, encoding="ascii")
    assert "unknown material 'unobtanium / mithril'; similar names: " in refused().error


@every_case(
    ("old", "new", "words"),
    [
        ("power_kw = 15\n", "", "curve[2].power_kw: missing"),
        ("power_kw = 15\n", "power_kw = -15\n", "curve[2].power_kw: -15 kW"),
        (
            "power_kw = 15\n",
            "power_kw = nan\n",
            "curve[2].power_kw: nan",
        ),
        ("power_kw = 15\n", "power_kw = 1e400\n", "power_kw: inf"),
        (
            "power_kw = 15\n",
            f"power_kw = 1{'0' * 320}\n",
            "curve[2].power_kw: 10000",
        ),
        ("[spindle]", f"a{'.a' * 30_000} = 1\n[spindle]", "more than 20 dotted"),
        (
            "power_kw = 15\n",
            "power_kw = '15'\n",
            "curve[2].power_kw: '15'",
        ),
        ("\nefficiency = 0.85", "\nefficiency = 0", "spindle.efficiency: 0 "),
        ("\nefficiency = 0.85", "\nefficiency = 1.5", "spindle.efficiency: 1.5 "),
        ("max_cutting_force_n = 8_000", "max_cutting_force_n = 0", "0 N is below 1 N"),
        ("max_cutting_force_n =", "max_cuting_force_n =", "max_cuting_force_n: unknown key"),
        ("\nmax_speed_rpm =", "\nmax_speed =", "spindle.max_speed: unknown key"),
        ("[spindle]", "[spindel]", "spind"),
        ('kind = "mill"', 'kind = "loom"', "loom"),
        ("[spindle]", "[spindle", "not valid TOML"),
    ],
)
def test_a_machine_file_with_a_fault_is_refused_with_key_value_bound_and_unit(
    tmp_path: Path, refused: Optimise, old: str, new: str, words: str
) -> None:
    assert old in VMC
    machine = tmp_path / "mine.toml"
    machine.write_text(VMC.replace(old, new, 1), encoding="utf-8")
    answer = refused("--machine", machine)
    assert f"{machine}: " in answer.error
    assert words in answer.error


# ------------------------------------------------------------------ files and disks


def test_an_input_that_is_a_folder_or_missing_is_refused(part: Path, refused: Optimise) -> None:
    assert "is a folder: name another folder with -o" in refused(file=part.parent).error
    missing = part.with_name("missing.stpnc")
    assert f"{missing}: No such file or directory" in refused(file=missing).error


def test_an_input_that_may_not_be_read_is_refused(
    part: Path, refused: Optimise, capsys: pytest.CaptureFixture[str]
) -> None:
    # Loads all that reads: a checkout that others keep closed is closed as well within.
    refused(file=part.with_name("missing.stpnc"))
    part.chmod(0o000)
    with (
        without(Capability.DAC_OVERRIDE, Capability.DAC_READ_SEARCH),
        pytest.raises(SystemExit) as stopped,
    ):
        optimise_main([str(part)])
    assert stopped.value.code == BAD_INPUT
    assert capsys.readouterr().err == f"error: {part}: Permission denied\n"
    assert list(inventory(part.parent)) == ["part.stpnc"]


def test_an_output_in_a_folder_that_may_not_be_written_is_refused(
    part: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part.parent.chmod(0o555)
    with without(Capability.DAC_OVERRIDE), pytest.raises(SystemExit) as stopped:
        optimise_main([str(part)])
    assert stopped.value.code == BAD_INPUT
    told = capsys.readouterr().err.splitlines()[-1]
    assert told == f"error: {part.with_name('part.optimised.stpnc')}: Permission denied"
    assert list(inventory(part.parent)) == ["part.stpnc"]


@pytest.mark.parametrize("place", ["missing/new.stpnc", "part.stpnc/new.stpnc", "folder"])
def test_an_output_that_has_no_place_is_refused(
    part: Path, refused: Optimise, place: str
) -> None:
    (part.parent / "folder").mkdir()
    assert str(part.parent / place) in refused("-o", part.parent / place).error


def test_an_output_in_a_folder_that_takes_no_files_is_refused(refused: Optimise) -> None:
    if not Path("/proc/self").is_dir():
        pytest.skip("no /proc on this system")
    assert "/proc/self/new.stpnc: " in refused("-o", "/proc/self/new.stpnc").error


@pytest.mark.parametrize("alias", ["./part.stpnc", "../folder/part.stpnc", "link", "hard"])
def test_the_input_is_never_the_output_by_whatever_name(
    part: Path, refused: Optimise, monkeypatch: pytest.MonkeyPatch, alias: str
) -> None:
    (part.parent / "link").symlink_to("part.stpnc")
    (part.parent / "hard").hardlink_to(part)
    monkeypatch.chdir(part.parent)
    answer = refused("-o", alias)
    assert "is the input file; use --in-place to overwrite it" in answer.error


def test_the_input_is_never_the_output_when_it_is_read_through_a_link(
    part: Path, refused: Optimise
) -> None:
    link = part.with_name("link.stpnc")
    link.symlink_to(part)
    assert "is the input file" in refused("-o", part, file=link).error


@pytest.mark.parametrize("options", [(), ("--in-place",)])
def test_a_disk_that_takes_no_more_leaves_everything_as_it_was(
    refused: Optimise, options: tuple[str, ...]
) -> None:
    with files_of_at_most(1_000):
        answer = refused(*options)
    assert "File too large" in answer.error


@pytest.mark.skipif(not CORPUS.is_dir(), reason="../shared/corpus is not here")
@pytest.mark.parametrize(
    ("name", "attribute"),
    [("ap238_cc1", "spindle"), ("ap238_cc3_14649-11_example1", "feedrate")],
)
def test_a_program_of_ap238_without_a_feed_or_speed_is_refused(
    tmp_path: Path, refused: Optimise, name: str, attribute: str
) -> None:
    path = CORPUS / "ap238" / f"{name}.stpnc"
    answer = refused("--material", "c45", "-o", tmp_path / "out.stpnc", file=path)
    assert f"MILLING_TECHNOLOGY.{attribute}" in answer.error
    assert not (tmp_path / "out.stpnc").exists()


# ------------------------------------------------------------------ files made to cost dear


@every_case("unit", ["#1=", "/*", "#1=A(/*", "ENDSEC;DATA;"])
@every_case(
    "words", [("check",), ("optimise", "--dry-run"), ("convert", "--profile", "standard")]
)
def test_a_program_of_endless_faults_is_refused_in_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...], unit: str
) -> None:
    path, output = tmp_path / "part.stpnc", tmp_path / "out.stpnc"
    path.write_text(HEAD + unit * (2_000_000 // len(unit)), encoding="ascii")
    command, *more = words
    place = ("-o", str(output)) if command == "convert" else ()
    with pytest.raises(SystemExit) as ended:
        main([command, str(path), *more, *place])
    assert ended.value.code == BAD_INPUT
    told = capsys.readouterr().err.splitlines()[-1]
    assert told.startswith("error: line ")
    assert len(told) < 300
    assert not output.exists()


def test_a_chain_of_workplans_is_listed_with_few_blanks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    count = 2000
    plans = (f"#{n}=WORKPLAN('',(#{n + 1}),$,$,$);\n" for n in range(1, count))
    path = tmp_path / "part.stpnc"
    text = f"{HEAD}{''.join(plans)}#{count}=WORKPLAN('',(),$,$,$);\nENDSEC;\nEND-ISO-10303-21;"
    path.write_text(text, encoding="ascii")
    with pytest.raises(SystemExit):
        main(["check", str(path)])
    assert len(capsys.readouterr().out) < 200 * count
