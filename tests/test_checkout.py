"""What is tested is the code beside the tests, in this process and in those that it starts."""

import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("stepnc_model", "simulator", "optimiser", "controller", "kbe", "service", "extras")


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_is_that_of_this_checkout(package: str) -> None:
    assert import_module(package).__file__ == str(ROOT / package / "__init__.py")


@pytest.mark.parametrize("program", ["stepnc", "optimise"])
def test_an_installed_program_runs_the_code_of_this_checkout(
    tmp_path: Path, program: str
) -> None:
    """Python tells on stderr where each module comes from."""
    done = subprocess.run(
        [Path(sys.executable).with_name(program), "--help"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONVERBOSE": "1"},
        capture_output=True,
        text=True,
        timeout=120.0,
        check=True,
    )
    assert str(ROOT / "service" / "cli" / "main.py") in done.stderr
