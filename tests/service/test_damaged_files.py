"""Damaged files of each kind that a command reads: an exit code, never another error.

``STEPNC_SEEDED`` sets how many files are read of each kind (``STEPNC_SEEDED=1000``).
"""

import os
from collections.abc import Callable
from pathlib import Path
from random import Random

import pyarrow as pa
import pytest
from pyarrow import parquet

import stepnc
from extras.learning.model_file import save_model
from tests.extras.learning.tables import law_table, written
from tests.service.damage import EXPECTED, PARTS, damaged, programs, run

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "examples"
DATA = ROOT / "simulator" / "data"
TIMES = max(4, int(os.environ.get("STEPNC_SEEDED", "0")))

CODE = b"""%
(base)
T1 M6
G21 G90 G54 G17
S1200 M3
G0 X0 Y0 Z5
G1 Z-2 F100
G2 X10 Y10 I5 J5 F200
G81 X20 Y20 Z-5 R2 F100
G80
M2
%
"""
TOOLS = b"number,kind,diameter_mm,teeth\n1,endmill,10,4\n2,drill,8,2\n"
LOG = b"time_s,x_mm,y_mm,z_mm,spindle_power_w\n" + b"".join(
    f"{0.1 * row:.1f},{row},0,{-row},{100 + row}\n".encode() for row in range(30)
)
RESPONSE = b"frequency_hz,real_um_n,imag_um_n\n" + b"".join(
    f"{100 + 5 * row},{0.01 * (row - 15)},{-1 / (1 + (row - 15) ** 2)}\n".encode()
    for row in range(30)
)
ASKED = ("--feed-mm-s", "50", "--spindle-rad-s", "100", "--depth-mm", "3", "--machine", "b")
STL = b"""solid box
facet normal 0 0 1
 outer loop
  vertex 0 0 0
  vertex 10 0 0
  vertex 0 10 0
 endloop
endfacet
endsolid box
"""


def part(name: str) -> str:
    return str(PARTS / name)


KINDS: dict[str, tuple[str, bytes, Callable[[str], list[str]]]] = {
    "Part 21": ("p.stpnc", (PARTS / "paper002.stpnc").read_bytes(), lambda f: ["toolpath", f]),
    "NC code": ("c.ngc", CODE, lambda f: ["check", f]),
    "NC code, Klartext": (
        "c.h",
        b"0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S1000\n2 L X+10 Y+0 R0 F200 M3\n3 END PGM A MM\n",
        lambda f: ["check", f],
    ),
    "canonical": ("c.ngc", CODE, lambda f: ["canonical", f, "--control", "linuxcnc"]),
    "machine": (
        "m.toml",
        (DATA / "machines" / "vmc15.toml").read_bytes(),
        lambda f: ["cycletime", part("paper002.stpnc"), "--machine", f],
    ),
    "material": (
        "m.toml",
        (DATA / "materials" / "c45.toml").read_bytes(),
        lambda f: ["optimise", part("paper002.stpnc"), "--machine", "vmc15", "--material", f,
                   "--dry-run"],
    ),
    "holding": (
        "h.toml",
        sorted((EXAMPLES / "holding").glob("*.toml"))[0].read_bytes(),
        lambda f: ["optimise", part("bracket.stpnc"), "--machine", "vmc15", "--holding", f,
                   "--dry-run"],
    ),
    "shop": (
        "s.toml",
        (EXAMPLES / "shops" / "line.toml").read_bytes(),
        lambda f: ["factory", f, "--hours", "1"],
    ),
    "tool table": (
        "t.csv",
        TOOLS,
        lambda f: ["simulate", "--nc", f.replace("t.csv", "c.ngc"), "--tools", f,
                   "--stock=-20,-20,-20,70,40,0", "--material", "c45", "--machine", "vmc15"],
    ),
    "log": (
        "l.csv",
        LOG,
        lambda f: ["verify", f, "--program", part("paper002.stpnc"), "--machine", "vmc15"],
    ),
    "spacings": (
        "b.csv",
        b"spacing_mm,feed_mm_min\n0.01,60\n0.1,600\n0.2,1200\n0.5,3000\n1,5000\n",
        lambda f: ["blockfit", f],
    ),
    "response": ("f.csv", RESPONSE, lambda f: ["taptest", f, "--direction", "x"]),
    "stock": (
        "b.stl",
        STL,
        lambda f: ["simulate", part("paper002.stpnc"), "--machine", "vmc15", "--stock", f],
    ),
    "document": (
        "d.xml",
        (ROOT / "tests" / "simulator" / "data" / "paper003.xml").read_bytes(),
        lambda f: ["blockfit", f],
    ),
}  # fmt: skip


@pytest.mark.filterwarnings("error")
def test_damaged_files_of_each_kind_end_with_an_exit_code(tmp_path: Path) -> None:
    rng, wrong = Random("damaged"), []
    aim = programs(tmp_path)["ap238.stpnc"]
    table = written(tmp_path, law_table(200, machines=("a", "b")))
    model = tmp_path / "model.skops"
    save_model(stepnc.learn(table, model="forest", train=100, test=60).model, model)
    spacings = tmp_path / "b.parquet"
    columns = {
        "spacing_mm": [0.01, 0.1, 0.2, 0.5],
        "feed_mm_min": [60.0, 600.0, 1200.0, 3000.0],
    }
    parquet.write_table(pa.table(columns), spacings)
    kinds = {
        **KINDS,
        "AP238": ("a.stpnc", aim, lambda f: ["check", f]),
        "model": ("model.skops", model.read_bytes(), lambda f: ["predict", f, *ASKED]),
        "Parquet": ("b.parquet", spacings.read_bytes(), lambda f: ["blockfit", f]),
    }
    (tmp_path / "c.ngc").write_bytes(CODE)
    for kind, (name, data, command) in kinds.items():
        for _ in range(TIMES):
            case = damaged(data, rng)
            (tmp_path / name).write_bytes(case)
            try:
                code, told = run(command(str(tmp_path / name)))
            except Exception as error:
                wrong.append(f"{kind}: {type(error).__name__}: {error}: {case[-60:]!r}")
                continue
            if code not in EXPECTED or "site-packages" in told:
                wrong.append(f"{kind}: exit {code}: {told[-200:]}")
    assert not wrong, "\n".join(wrong)


def test_integers_feeds_and_responses_beyond_numbers_are_refused(tmp_path: Path) -> None:
    digits = b"1" * 400
    aim = programs(tmp_path)["ap238.stpnc"]
    plain = (PARTS / "paper002.stpnc").read_bytes()
    first = aim.index(b"CARTESIAN_POINT(")
    number = aim.index(b"(", first + 16) + 1
    end = min(aim.index(mark, number) for mark in (b",", b")"))
    cases = {
        "a.stpnc": (aim[:number] + digits + aim[end:], ["check"]),
        "p.stpnc": (plain.replace(b"#52,4,", b"#52," + digits + b","), ["toolpath"]),
        "b.csv": (b"spacing_mm,feed_mm_min\n0.01,60\n0.1,1e-308\n0.2,1200\n", ["blockfit"]),
        "f.csv": (RESPONSE.replace(b"-1.0\n", b"-1e300\n"), ["taptest", "--direction", "x"]),
    }
    for name, (data, command) in cases.items():
        path = tmp_path / name
        path.write_bytes(data)
        code, told = run([command[0], str(path), *command[1:]])
        assert code == 3, (name, told)
        assert "site-packages" not in told, name
