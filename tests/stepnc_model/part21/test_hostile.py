"""Files made to cost the reader dear: refused or reported in bounded time and memory.

Sizes are small; the bounds on memory and time are those within which a reader that is linear
stays by a factor of ten, and one that is quadratic, or describes every fault, does not.
"""

import subprocess
import sys
from pathlib import Path

import pytest

from stepnc_model.errors import MOST_FINDINGS, Part21Error, Severity
from stepnc_model.part21 import reader
from stepnc_model.part21.grammar import MAX_INSTANCE
from stepnc_model.part21.places import MOST_OF_FILE, MOST_OF_INSTANCE
from stepnc_model.part21.reader import Part21File

HEAD = (
    b"ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
    b"FILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('A'));\nENDSEC;\nDATA;\n"
)
TAIL = b"\nENDSEC;\nEND-ISO-10303-21;\n"
OPEN = b"ISO-10303-21;\nHEADER;\n"
SIZE = 1_000_000

UNITS = {
    "heads": b"#1=",
    "heads with an unclosed comment": b"#1=/*",
    "unclosed comments": b"/*",
    "nested comments": b"/*/**/",
    "empty comments": b"/**/",
    "apostrophes": b"'",
    "strings with heads": b"'#1=",
    "brackets": b"(",
    "instances that do not close": b"#1=A(",
    "semicolons": b";",
    "slashes": b"/",
    "letters that might end a section": b"E",
    "letters that might begin one": b"D",
    "sections": b"ENDSEC;DATA;",
    "sections within sections": b"DATA;\n",
    "parameters of a section": b"DATA(;",
    "ends": b"ENDSEC;",
    "quotes": b'"',
    "one id": b"#1=A();",
    "nothing": b"\0",
}

SHAPES = {
    **{name: HEAD + unit * (SIZE // len(unit)) + TAIL for name, unit in UNITS.items()},
    "comment that nests and ends": HEAD + b"/*" * (SIZE // 2) + b"*/" + TAIL,
    "stars": HEAD + b"/*" + b"*" * SIZE + b"/" + TAIL,
    "digits": HEAD + b"#" + b"9" * SIZE + TAIL,
    "one string": HEAD + b"#1=A('" + b"x" * SIZE + b"');" + TAIL,
    "one name": HEAD + b"#1=" + b"A" * SIZE + b"();" + TAIL,
    "one list": HEAD + b"#1=A(#1" + b",#1" * (SIZE // 3) + b");" + TAIL,
    "strings in one instance": HEAD + b"#1=A(''" + b",''" * (SIZE // 3) + b");" + TAIL,
    "open brackets before closed ones": HEAD
    + b"".join(b"#%d=A(" % n for n in range(1, 400))
    + b"()" * (SIZE // 2)
    + TAIL,
    "open header entities": OPEN + b"A(/**/" * 400 + b"()" * (SIZE // 2) + b"ENDSEC;" + TAIL,
    "header entities": OPEN + b"A();" * (SIZE // 4) + b"ENDSEC;DATA;" + TAIL,
    "header entities run together": OPEN + b"A()" * (SIZE // 3) + b"ENDSEC;DATA;" + TAIL,
    "headers": OPEN * (SIZE // len(OPEN)),
    "header without end": OPEN + b"a " * (SIZE // 2),
    "comments behind the first word": b"ISO-10303-21" + b"/**/" * (SIZE // 4) + TAIL,
    "names": HEAD + b"".join(b"#%d=A%d();" % (n, n) for n in range(1, 60_000)) + TAIL,
    "missing semicolons": HEAD + b"".join(b"#%d=A()" % n for n in range(1, 60_000)) + TAIL,
    "deviations": HEAD + b"".join(b"#%d=A(X);" % n for n in range(1, 60_000)) + TAIL,
    "deviations in one": HEAD + b"#1=A(X" + b",X" * 200_000 + b");" + TAIL,
}

READ = """
import resource, sys
from pathlib import Path
from stepnc_model.errors import StepNcError
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
resource.setrlimit(resource.RLIMIT_AS, (400 << 20, 400 << 20))
resource.setrlimit(resource.RLIMIT_CPU, (60, 60))
for path in map(Path, sys.argv[1:]):
    print(path.stem, end=": ", flush=True)
    try:
        file = Part21File.from_bytes(path.read_bytes())
        print(len(file.findings), "findings", flush=True)
        Program(file).findings()
    except StepNcError as error:
        print("refused", len(str(error)), flush=True)
"""


def test_hostile_files_are_refused_or_reported_within_time_and_memory(tmp_path: Path) -> None:
    paths = []
    for name, data in SHAPES.items():
        path = tmp_path / f"{name}.stpnc"
        path.write_bytes(data)
        paths.append(str(path))
    done = subprocess.run(
        [sys.executable, "-c", READ, *paths], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-200:] + done.stderr[-500:]
    told = [int(line.split(" ")[-1]) for line in done.stdout.splitlines() if "refused" in line]
    assert told
    assert max(told) < 500


def test_more_deviations_of_the_frame_than_the_most_are_refused_with_a_place() -> None:
    just = HEAD + b"".join(b"#%d=A()\n" % n for n in range(1, MOST_OF_FILE + 1)) + TAIL
    assert len(Part21File.from_bytes(just).structure.slips) == MOST_OF_FILE
    more = just.replace(TAIL, b"#999999=A()\n" + TAIL)
    with pytest.raises(Part21Error, match=r"line 10008, .*more than 10000 deviations"):
        Part21File.from_bytes(more)


def test_an_instance_longer_than_the_most_is_refused_with_its_name_and_line() -> None:
    body = b"#1=A();\n#7=A('%s');"
    room = MAX_INSTANCE - len(b"#7=A('');")
    assert len(Part21File.from_bytes(HEAD + body % (b"x" * room) + TAIL)) == 2
    with pytest.raises(Part21Error, match=f"line 9, .*#7 is {MAX_INSTANCE + 1} bytes long"):
        Part21File.from_bytes(HEAD + body % (b"x" * (room + 1)) + TAIL)


def test_of_many_findings_the_first_are_listed_and_the_others_counted() -> None:
    bad = b"".join(b"#%d=A(X);\n#%d=A(?);\n" % (2 * n, 2 * n + 1) for n in range(1, 1501))
    findings = Part21File.from_bytes(HEAD + bad + TAIL).findings
    for severity, word in ((Severity.WARNING, "warnings"), (Severity.ERROR, "errors")):
        listed = [each for each in findings if each.severity is severity]
        assert len(listed) == MOST_FINDINGS + 1
        assert listed[-1].message == f"500 more {word} are not listed here"
    assert [each.line for each in findings[:3]] == [8, 9, 10]


def test_deviations_of_one_instance_are_listed_and_the_others_counted() -> None:
    text = b"#1=A(X" + b",X" * (MOST_OF_INSTANCE + 9) + b");"
    *listed, rest = Part21File.from_bytes(HEAD + text + TAIL).findings
    assert len(listed) == MOST_OF_INSTANCE
    assert rest.message == "10 more warnings are not listed here"


def test_a_check_says_what_it_did_not_look_at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reader, "MAX_EXAMINED", 30)
    text = b"#1=A(1.);\n" + b"".join(b"#%d=A(X);\n" % n for n in range(2, 7))
    file = Part21File.from_bytes(HEAD + text + TAIL)
    assert [file.is_examined(id) for id in range(1, 7)] == [True] * 4 + [False] * 2
    assert file.findings[-1].message.startswith("2 instances from here on")
    assert file.findings[-1].line == 12
    assert len(file.findings) == 4
    assert file.parameters(6) == ("X",)


def test_a_string_or_comment_of_any_length_is_read() -> None:
    text = b"/*" + b"* / " * 50_000 + b"*/#1=A('" + b"#2=''" * 20_000 + b"'/*" + b"*" * 9999
    file = Part21File.from_bytes(HEAD + text + b"*/);" + TAIL)
    (value,) = file.parameters(1)
    assert value == "#2='" * 20_000
    assert not [each for each in file.findings if each.severity is Severity.ERROR]
