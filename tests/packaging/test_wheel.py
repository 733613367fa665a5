"""The wheel holds all that the programs need, and runs where it alone is installed."""

import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from zipfile import ZipFile

import pytest

from simulator.kernels import store
from tests.service.waiting import ROOT, environment

MOST_BYTES = 4_000_000

BUILD = "import sys, setuptools.build_meta as b; print(b.build_wheel(sys.argv[1]))"


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel built from a copy of the sources: building writes beside them."""
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    ignored = shutil.ignore_patterns(
        ".*", "__pycache__", "*.egg-info", "build", "tests", "benchmarks"
    )
    shutil.copytree(ROOT, source, ignore=ignored)
    subprocess.run(
        [sys.executable, "-c", BUILD, str(folder)],
        cwd=source, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=600, check=True,
    )  # fmt: skip
    (found,) = folder.glob("*.whl")
    return found


def test_the_wheel_has_every_file_of_the_packages(wheel: Path) -> None:
    names = set(ZipFile(wheel).namelist())
    listed = subprocess.run(
        ["git", "ls-files", "stepnc_model", "simulator", "optimiser", "controller", "kbe",
         "service", "extras", "stepnc"],
        cwd=ROOT, capture_output=True, text=True, timeout=120.0, check=True,
    )  # fmt: skip
    assert set(listed.stdout.split("\n")) - {""} <= names
    assert not [name for name in names if name.startswith(("tests/", "benchmarks/"))]
    assert wheel.stat().st_size < MOST_BYTES


def test_the_wheel_runs_in_an_environment_of_its_own(wheel: Path, tmp_path: Path) -> None:
    """Other packages are borrowed: their folder is searched last, and links none of ours.

    So is machine code, which is named by all that it depends on: making it takes long.
    """
    programs = tmp_path / "environment" / "bin"
    python = str(programs / "python")
    plain = {k: v for k, v in environment(tmp_path).items() if k != "PYTHONPATH"}

    def run(*words: str, **more: str) -> str:
        done = subprocess.run(
            words, cwd=tmp_path, env={**plain, **more},
            capture_output=True, text=True, timeout=600, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    run(sys.executable, "-m", "venv", "--without-pip", str(programs.parent))
    pip = (sys.executable, "-m", "pip", "--python", python)
    run(*pip, "install", "--quiet", "--no-index", "--no-deps", str(wheel))
    caches = tmp_path / "caches"
    caches.mkdir()
    (caches / "stepnc-optimiser").symlink_to(store.PACKAGE_CACHE)
    plain["XDG_CACHE_HOME"] = str(caches)
    borrowed = {"PYTHONPATH": sysconfig.get_path("purelib")}
    place = run(python, "-c", "import service; print(service.__file__)", **borrowed)
    assert Path(place).is_relative_to(programs.parent)
    part = str(ROOT / "examples" / "parts" / "paper002.stpnc")
    words = (part, "--mode", "TC", "--machine", "vmc15", "--material", "c45")
    table = run(str(programs / "optimise"), *words, "-o", "part.stpnc", **borrowed)
    assert "ROUGH THE FACE" in table
    assert "vmc15" in run(str(programs / "stepnc"), "machines", **borrowed)
    assert (tmp_path / "part.stpnc").is_file()
