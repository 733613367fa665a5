"""Outputs of a command differ from each other and from its inputs, found from the parser."""

import argparse
import os
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

import pytest

from service.cli.commands import CommandParser, parser, require_own_places
from service.cli.main import main
from service.files import require_distinct
from service.requests.fields import output_path
from stepnc_model.errors import StepNcError, WriteError

PARTS = Path(__file__).parents[3] / "examples" / "parts"


def commands_of(
    top: argparse.ArgumentParser, names: tuple[str, ...] = ()
) -> Iterator[tuple[tuple[str, ...], CommandParser]]:
    """Commands with their names, those below others too."""
    for action in top._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, each in action.choices.items():
                each.complete()
                yield (*names, name), each
                yield from commands_of(each, (*names, name))


def actions_of(command: argparse.ArgumentParser, kind: object) -> list[argparse.Action]:
    return [each for each in command._actions if each.type is kind]


def test_two_outputs_of_any_command_are_two_files(tmp_path: Path) -> None:
    pairs = 0
    for names, command in commands_of(parser()):
        outputs = [each.dest for each in actions_of(command, output_path)]
        for one, other in combinations(outputs, 2):
            options = argparse.Namespace(output_names=tuple(outputs), **dict.fromkeys(outputs))
            setattr(options, one, tmp_path / "x.out")
            setattr(options, other, tmp_path / "no" / ".." / "x.out")
            with pytest.raises(WriteError, match="name another file"):
                require_own_places(options)
            pairs += 1
        assert names
    assert pairs >= 12


def test_no_output_of_any_command_is_one_of_its_inputs(tmp_path: Path) -> None:
    file = tmp_path / "in.dat"
    file.write_text("", encoding="ascii")
    for names, command in commands_of(parser()):
        for output in actions_of(command, output_path):
            for given in actions_of(command, Path):
                if "in_place" in {each.dest for each in command._actions} and (
                    output.dest,
                    given.dest,
                ) == ("output", "file"):
                    continue
                options = argparse.Namespace(output_names=(output.dest,))
                setattr(options, output.dest, file)
                setattr(options, given.dest, file)
                with pytest.raises(WriteError):
                    require_own_places(options)
                assert names


def test_a_command_line_knows_its_outputs_before_it_starts(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    part = tmp_path / "part.ngc"
    part.write_text("G21 G90\nT1 M6\nM3 S1000\nG1 X10 F100\nM2\n", encoding="ascii")
    out, link = tmp_path / "out.ngc", tmp_path / "link.csv"
    link.symlink_to(out)
    step = tmp_path / "p.stpnc"
    step.write_bytes((PARTS / "paper002.stpnc").read_bytes())
    for arguments in (
        ["optimise", part, "-o", out, "--report", out],
        ["optimise", part, "-o", out, "--feeds-csv", link],
        ["optimise", part, "--in-place", "--report", part],
        ["optimise", step, "--report", out, "--feeds-csv", tmp_path / "OUT.NGC"],
        ["post", step, "--control", "fanuc", "-o", step],
        ["blockfit", part, "-o", out, "--report", out],
        ["simulate", step, "-o", tmp_path / "a.csv", "--mtconnect", tmp_path / "a.csv"],
        ["taptest", part, "--direction", "x", "--machine", str(step), "-o", step],
    ):
        before = sorted(tmp_path.iterdir())
        with pytest.raises(SystemExit) as stopped:
            main([str(each) for each in arguments])
        assert stopped.value.code == 3, arguments
        assert "name another file" in capsys.readouterr().err, arguments
        assert sorted(tmp_path.iterdir()) == before


def test_hard_links_and_case_are_seen_through(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_text("", encoding="ascii")
    os.link(one, other)
    with pytest.raises(WriteError):
        require_distinct([one, other])
    with pytest.raises(StepNcError):
        require_distinct([tmp_path / "new.html", tmp_path / "NEW.html"])
    require_distinct([one, None, tmp_path / "new.html"], apart_from=[None, tmp_path / "x"])
