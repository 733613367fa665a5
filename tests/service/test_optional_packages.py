"""The core runs without the packages of the extras, and what needs one says how to get it."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from service.optional_packages import EXTRAS, OF_VERBS, MissingExtra, missing_extras_named
from tests.service.waiting import ROOT, environment

WITHOUT = f"""
import sys

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in {sorted(EXTRAS)!r}:
            raise ModuleNotFoundError(f"No module named {{name!r}}", name=name)

sys.meta_path.insert(0, Missing())
from service.cli.main import main
code = 0
for words in sys.argv[1].split("\\n"):
    try:
        main(words.split())
    except SystemExit as stopped:
        code = code or stopped.code
sys.exit(code)
"""
"""runs commands, a line each, where no package of an extra is installed"""

CHOSEN = "--machine vmc15 --material c45"


def run(folder: Path, *lines: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, "-c", WITHOUT, "\n".join(lines)],
        cwd=folder, env={**environment(folder), "PYTHONPATH": str(ROOT)},
        capture_output=True, text=True, timeout=600, check=False,
    )  # fmt: skip


def test_the_core_needs_no_extra(tmp_path: Path) -> None:
    part = ROOT / "examples" / "parts" / "paper002.stpnc"
    done = run(
        tmp_path,
        f"optimise {part} {CHOSEN} -o part.stpnc --report plan.html",
        "check part.stpnc",
        "post part.stpnc --control linuxcnc -o part.ngc",
        "convert part.stpnc --to ap238 -o part.stp",
        f"simulate part.stpnc {CHOSEN} -o run.csv --report run.html",
        f"control part.stpnc {CHOSEN} --preview --kb shop.db -o control.csv",
        "kbe review --kb shop.db",
        "kbe export outcomes --kb shop.db -o outcomes.csv",
    )
    assert done.returncode == 0, done.stderr
    assert {"plan.html", "run.csv", "control.csv", "outcomes.csv"} <= {
        path.name for path in tmp_path.iterdir()
    }


@pytest.mark.parametrize(
    ("line", "extra"),
    [
        (f"simulate {{part}} {CHOSEN} -o run.parquet", "parquet"),
        ("toolpath {part} --plot path.png", "plot"),
        ("learn table.csv --target time_s", "learn"),
        ("verify run.csv --program {part} --machine vmc15", "parquet"),
        ("agent --mqtt 127.0.0.1:1883 --device {part}", "mqtt"),
    ],
)
def test_a_verb_whose_extra_is_missing_says_how_to_get_it(
    tmp_path: Path, line: str, extra: str
) -> None:
    part = ROOT / "examples" / "parts" / "paper002.stpnc"
    done = run(tmp_path, line.format(part=part))
    assert done.returncode == 3, done.stderr
    last = done.stderr.splitlines()[-1]
    assert last.startswith("error: ")
    assert last.endswith(f": pip install 'stepnc-optimiser[{extra}]'")
    assert not list(tmp_path.glob("run*"))


def test_extras_are_those_of_the_project() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    known = set(project["optional-dependencies"])
    assert {*EXTRAS.values(), *OF_VERBS.values()} == known - {"all", "dev"}


def test_another_missing_module_is_a_fault_of_ours() -> None:
    with pytest.raises(ModuleNotFoundError), missing_extras_named("simulate"):
        raise ModuleNotFoundError("No module named 'nonesuch'", name="nonesuch")
    with pytest.raises(MissingExtra, match=r"\[learn\]"), missing_extras_named("predict"):
        raise ModuleNotFoundError("No module named 'pyarrow.csv'", name="pyarrow.csv")
