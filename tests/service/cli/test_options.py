"""What the commands share."""

import argparse
from pathlib import Path

import pytest

from service.cli import options as cli_options
from service.cli.interrupts import INTERRUPTED
from service.cli.options import add_json
from service.requests.fields import add_options, from_options
from service.verbs.toolpath.request import ToolPathFiles, ToolPathRequest
from stepnc_model.post.dialect import Dialect


def test_exit_codes_can_be_told_apart_and_none_is_that_of_usage() -> None:
    names = ("OK", "BAD_INPUT", "INFEASIBLE", "LIMIT_EXCEEDED")
    codes = {INTERRUPTED, *(getattr(cli_options, name) for name in names)}
    assert len(codes) == len(names) + 1
    assert 2 not in codes


def test_every_control_is_named() -> None:
    assert all(control.value in cli_options.CONTROLS for control in Dialect)


def test_a_file_is_asked_for_and_units_and_json_need_not_be_given() -> None:
    parser = argparse.ArgumentParser()
    add_options(parser, ToolPathFiles)
    add_options(parser, ToolPathRequest)
    add_json(parser)
    options = parser.parse_args(["part.stpnc"])
    assert (options.file, options.json) == (Path("part.stpnc"), False)
    assert from_options(ToolPathRequest, options) == ToolPathRequest()
    assert parser.parse_args(["part.stpnc", "--units", "rpm-mmin", "--json"]).json
    with pytest.raises(SystemExit):
        parser.parse_args([])
