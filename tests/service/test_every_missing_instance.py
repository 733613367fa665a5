"""Every instance of every sample left out in turn, for every command that reads a program."""

import os
from pathlib import Path
from random import Random

from tests.service.damage import PROGRAM_COMMANDS, failures, programs, without_each

SHARE = float(os.environ.get("STEPNC_SEEDED", "40")) / 400.0
"""Share of the longer commands that are run; 1000 cases and more: all of them."""


def test_every_instance_left_out(tmp_path: Path) -> None:
    rng, wrong = Random("every"), []
    for name, data in programs(tmp_path).items():
        for id, case in without_each(data).items():
            commands = [
                each
                for row, each in enumerate(PROGRAM_COMMANDS)
                if row == 0 or rng.random() < SHARE
            ]
            wrong += failures(tmp_path / name, case, commands, f"{name} without #{id}")
    assert not wrong, "\n".join(wrong)
