"""Messages name files as their owners do, never by their paths."""

from pathlib import Path

import pytest

from service.errors import NotFound
from service.files import naming, with_names
from stepnc_model.errors import StepNcError

NAMES = {Path("/data/files/abc.csv"): "run.csv", Path("/data/programs/def.stpnc"): "part.stpnc"}


def test_paths_and_their_names_become_the_owners() -> None:
    text = "/data/files/abc.csv: row 3 is not of def.stpnc"
    assert with_names(text, NAMES) == "run.csv: row 3 is not of part.stpnc"


def test_a_name_that_holds_the_end_of_its_path_is_named_once() -> None:
    names = {Path("/data/jobs/7/optimised.stpnc"): "part.optimised.stpnc"}
    for text in ("/data/jobs/7/optimised.stpnc", "optimised.stpnc", "part.optimised.stpnc"):
        assert with_names(f"{text}: no feed", names) == "part.optimised.stpnc: no feed"


def test_an_error_that_names_a_path_names_the_file() -> None:
    with pytest.raises(StepNcError, match=r"^run\.csv: no rows$"), naming(NAMES):
        raise StepNcError("/data/files/abc.csv: no rows")


def test_other_errors_keep_their_kind() -> None:
    with pytest.raises(NotFound), naming(NAMES):
        raise NotFound("log", "xyz")
