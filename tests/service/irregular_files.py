"""Commands on files that are none: run by ``test_irregular_files.py`` in a process of its own.

The process prints each case before it begins, and ends where one takes longer than its limit.
"""

import contextlib
import faulthandler
import io
import json
import os
import random
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

PARTS = Path(__file__).parents[2] / "examples" / "parts"
PART = str(PARTS / "paper002.stpnc")

LIMIT = 20.0
"""Longest time of one case, in s; the first that needs numpy takes some."""

CODE = ("--nc", "good.ngc", "--machine", "vmc15", "--material", "c45")
STOCK = ("--stock", "0,0,-5,9,9,0", "--material", "c45")
LOGGED = ("--machine", "vmc15", "--program", PART)
COMMANDS: tuple[tuple[str, ...], ...] = (
    ("check", "F.stpnc"),
    ("check", "F.ngc"),
    ("toolpath", "F.stpnc"),
    ("post", "F.stpnc", "--control", "linuxcnc"),
    ("canonical", "F.ngc", "--control", "linuxcnc"),
    ("convert", "F.stpnc", "--to", "ap238", "-o", "out.stpnc"),
    ("optimise", "F.stpnc"),
    ("optimise", "F.ngc", "--tools", "good.toml", *STOCK),
    ("optimise", "good.ngc", "--tools", "F.csv", *STOCK),
    ("optimise", "good.ngc", "--tools", "good.toml", "--stock", "F.stl", "--material", "c45"),
    ("optimise", PART, "--dry-run", "--holding", "F.toml"),
    ("optimise", PART, "--dry-run", "--tools", "F.toml"),
    ("optimise", PART, "--dry-run", "--kb", "F.db"),
    ("optimise", PART, "--dry-run", "--machine", "F.toml"),
    ("optimise", PART, "--dry-run", "--machine", "F.xml"),
    ("optimise", PART, "--dry-run", "--material", "F.toml"),
    ("simulate", "F.stpnc"),
    ("simulate", "--nc", "F.ngc", "--machine", "vmc15"),
    *(
        ("simulate", *CODE, "--tools", f"F{suffix}")
        for suffix in (".toml", ".csv", ".tbl", ".json", ".tools", ".hsmlib", ".fctl")
    ),
    *(
        ("simulate", *CODE, "--tools", "good.toml", "--stock", f"F{suffix}")
        for suffix in (".stl", ".step", ".npz")
    ),
    ("control", "F.stpnc"),
    ("control", PART, "--machine", "vmc15", "--recorded", "F.parquet"),
    ("control", PART, "--machine", "vmc15", "--recorded", "F.csv"),
    ("control", PART, "--machine", "vmc15", "--kb", "F.db"),
    ("calibrate", "F.csv", "--program", PART, "--machine", "vmc15"),
    ("calibrate", "F.parquet", "--program", PART, "--machine", "vmc15"),
    ("calibrate", "good.csv", "--program", "F.stpnc", "--machine", "vmc15"),
    ("calibrate", "--tool-life", "F.csv"),
    ("taptest", "F.csv", "--direction", "x", "--workpiece"),
    (
        "taptest",
        "frf.csv",
        "--direction",
        "x",
        "--workpiece",
        "--machine",
        "F.toml",
        "-o",
        "m.toml",
    ),
    ("blocktest", "-o", "out.ngc", "--machine", "F.toml"),
    ("blockfit", "F.csv"),
    ("blockfit", "F.parquet", "--program", "good.ngc"),
    ("blockfit", "good.csv", "--program", "F.ngc"),
    ("cycletime", "F.stpnc", "--machine", "vmc15"),
    ("cycletime", "F.ngc", "--machine", "vmc15"),
    *(
        ("cycletime", PART, f"F{suffix}", "--machine", "vmc15")
        for suffix in (".csv", ".parquet", ".xml")
    ),
    *(
        ("verify", f"F{suffix}", *LOGGED)
        for suffix in (".csv", ".parquet", ".xml", ".shdr", ".log")
    ),
    ("verify", "good.csv", "--machine", "vmc15", "--program", "F.stpnc"),
    ("verify", "good.csv", *LOGGED, "--tools", "F.toml"),
    ("verify", "good.csv", *LOGGED, "--required", "F.stl"),
    ("verify", "good.csv", *LOGGED, "--required", "F.step"),
    ("agent", "F.stpnc", "--port", "0"),
    *(
        ("agent", f"F{suffix}", "--machine", "vmc15", "--port", "0")
        for suffix in (".csv", ".parquet", ".xml", ".shdr", ".log")
    ),
    ("agent", "--device", "F.xml", "--adapter", "127.0.0.1:1", "--port", "0"),
    ("kbe", "list", "--kb", "F.db"),
    ("kbe", "show", "1", "--kb", "F.db"),
    ("kbe", "table", "--kb", "F.db"),
    ("kbe", "review", "--kb", "F.db"),
    ("kbe", "corrections", "--kb", "F.db"),
    ("kbe", "export", "outcomes", "-o", "out.csv", "--kb", "F.db"),
    ("kbe", "check", "--kb", "F.db"),
    ("kbe", "add", "F.json", "--kb", "out.db"),
    ("kbe", "backup", "out.backup", "--kb", "F.db"),
    ("kbe", "restore", "F.backup", "--kb", "out2.db"),
    ("kbe", "write", "F.stpnc", "-o", "out.stpnc", "--kb", "out.db"),
    ("kbe", "read", "F.stpnc"),
    ("factory", "F.toml"),
    ("factory", "F.json"),
    ("dataset", "F.toml", "-o", "out"),
    ("learn", "F.csv", "-o", "out.model"),
    ("learn", "F.parquet", "-o", "out.model"),
    ("predict", "F.model", "good.csv"),
    ("score", "F.model", "good.csv"),
    ("serve", "--data", "F.data", "--port", "0"),
    ("serve", "--data", "data", "--port", "0", "--tls-cert", "F.pem", "--tls-key", "F.pem"),
    ("keys", "list", "--data", "F.data"),
    ("machines", "F.toml"),
    ("machines", "F.xml"),
    ("materials", "F.toml"),
)
"""Commands; ``F`` with a suffix is the file that is none."""

FOLDERS_ARE_FINE = {("optimise", "F.stpnc"), ("serve", "F.data"), ("keys", "F.data")}
"""Commands and arguments that take a folder."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """Command on one kind of file."""

    command: tuple[str, ...]
    kind: str

    @property
    def words(self) -> list[str]:
        """Arguments of the command line."""
        return [
            f"{self.kind}{word[1:]}" if word.startswith("F.") else word for word in self.command
        ]


KINDS = ("pipe", "device", "folder", "loop")


def cases(seed: int | None) -> list[Case]:
    """One kind of file for each command, chosen by a seed; all kinds without one."""
    chance = random.Random(seed)
    found: list[Case] = []
    for command in COMMANDS:
        takes_folder = any((command[0], word) in FOLDERS_ARE_FINE for word in command)
        kinds = [kind for kind in KINDS if not (kind == "folder" and takes_folder)]
        chosen = kinds if seed is None else [chance.choice(kinds)]
        found += [Case(command=command, kind=kind) for kind in chosen]
    return found


def make_files(folder: Path) -> None:
    """Make files of all kinds with all suffixes, and some that are as they should be."""
    suffixes = {word[1:] for command in COMMANDS for word in command if word.startswith("F.")}
    for suffix in suffixes:
        os.mkfifo(folder / f"pipe{suffix}")
        (folder / f"device{suffix}").symlink_to("/dev/zero")
        (folder / f"folder{suffix}").mkdir()
        (folder / f"loop{suffix}").symlink_to(f"loop{suffix}")
    (folder / "good.ngc").write_text("G21 G90\nT1 M6\nS1000 M3\nG0 X0 Y0 Z5\nG1 X1 F100\nM2\n")
    heading = "time_s,x_mm,y_mm,z_mm,electric_wattage,load_wattage"
    rows = [f"{row},{row},0,0,{100 + row},10" for row in range(20)]
    (folder / "good.csv").write_text("\n".join((heading, *rows, "")))
    response = [f"{100 + row},0.01,-0.02" for row in range(200)]
    (folder / "frf.csv").write_text("\n".join(("frequency_hz,real_um_n,imag_um_n", *response)))
    (folder / "good.toml").write_text(
        '[[tool]]\nnumber = 1\nid = "T1"\nkind = "endmill"\ndiameter_mm = 8.0\nteeth = 2\n'
    )


def results(chosen: list[Case]) -> Iterator[dict[str, object]]:
    """Run commands, each with what it told."""
    from service.cli.main import main  # noqa: PLC0415 (after the files are made)

    for case in chosen:
        say({"begins": case.words})
        faulthandler.dump_traceback_later(LIMIT, exit=True, file=2)
        told, code = io.StringIO(), 0
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(told):
            try:
                main(case.words)
            except SystemExit as ended:
                code = int(ended.code or 0)
            except BaseException as error:
                told.write(f"{type(error).__name__}: {error}")
                code = -1
        faulthandler.cancel_dump_traceback_later()
        yield {"words": case.words, "code": code, "told": told.getvalue()}


def run(folder: str, seed: str = "") -> None:
    """Run the cases of a seed within a folder."""
    os.chdir(folder)
    make_files(Path(folder))
    for each in results(cases(int(seed) if seed else None)):
        say(each)


def say(words: dict[str, object]) -> None:
    """Write one line, at once."""
    os.write(1, f"{json.dumps(words)}\n".encode())


if __name__ == "__main__":
    run(*sys.argv[1:])
