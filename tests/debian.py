"""Programs that tests need and pip does not have: Debian's, installed where one may."""

import fcntl
import os
import shutil
import subprocess
from pathlib import Path

import pytest


def installed(program: str, package: str) -> str:
    """Path of a program; if it cannot be installed the test is skipped, and says why."""
    found = shutil.which(program)
    if found is not None:
        return found
    if os.geteuid() != 0 or shutil.which("apt-get") is None:
        pytest.skip(f"{package} is not installed, and may not be (apt-get install {package})")
    # Several processes of tests may come here at once.
    with Path("/tmp/stepnc-debian.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        for words in (["update"], ["install", "-y", "--no-install-recommends", package]):
            if shutil.which(program) is not None:
                break
            done = subprocess.run(
                ["apt-get", "-qq", *words],
                capture_output=True,
                timeout=900,
                check=False,
                env={**os.environ, "DEBIAN_FRONTEND": "noninteractive"},
            )
            if done.returncode:
                pytest.skip(f"apt-get {words[0]}: {done.stderr.decode()[-200:]}")
    found = shutil.which(program)
    if found is None:
        pytest.skip(f"{program} is not there after apt-get install {package}")
    return found
