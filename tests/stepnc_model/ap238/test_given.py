"""Data that an AP238 file lacks, given by the user: it stays a file of AP238."""

from collections.abc import Callable
from functools import cache

import pytest

from stepnc_model.ap238.export import to_ap238
from stepnc_model.ap238.view import AimView, is_aim
from stepnc_model.ap238.writing import spliced_into
from stepnc_model.draft import Draft
from stepnc_model.errors import SchemaError
from stepnc_model.given import Completed, GivenData, GivenFeed, completed, without_given
from stepnc_model.program import Program
from stepnc_model.technology import programmed
from stepnc_model.tool import tool_of
from stepnc_model.units import FeedUnit
from tests.stepnc_model.ap238.samples import MILLING, exported, own, public, read

FEED = GivenFeed(value=4.0, unit=FeedUnit.MM_PER_MINUTE)


def written(whole: Completed) -> Program:
    """The program as it is written with its given data."""
    view = whole.program.file
    assert isinstance(view, AimView)
    return Program(read(spliced_into(view, view.data)))


def instances(data: bytes) -> dict[int, bytes]:
    """Text of each instance."""
    file = read(data)
    return {id: data[slice(*file.span(id))] for id in file.ids()}


def depth_of(program: Program) -> float:
    """Depth of the first feature, mm."""
    feature = program.get(program.workingsteps[0].features[0])
    plane = program.get(feature.depth)  # type: ignore[attr-defined]
    place = program.get(plane.position)
    return float(-program.get(place.location).coordinates[2])


def teeth_of(program: Program) -> float:
    """Number of teeth of the first tool."""
    return float(tool_of(program, program.workingsteps[0].tool_ref).teeth)


def feed_of(program: Program) -> float:
    """Feed of the fourth workingstep, mm/s."""
    return programmed(program, program.workingsteps[3].technology_ref).feed.value


def lacking(name: str, attribute: str) -> bytes:
    """Sample program of AP238 whose first feature lacks an attribute."""
    program = Program(own(name))
    draft = Draft(program)
    draft.put(program.workingsteps[0].features[0], attribute, None)
    return to_ap238(read(draft.edits.apply())).data


def first_feature(data: bytes) -> int:
    """Number of the feature of the first workingstep."""
    return int(Program(read(data)).workingsteps[0].features[0])


@cache
def cases() -> dict[str, tuple[bytes, GivenData, Callable[[Program], float], float]]:
    """Files, what is given to them, what it is read by, and its value."""
    flat = lacking("bracket", "depth")
    depth = GivenData(values=(f"#{first_feature(flat)}.depth=7.5",))
    return {
        "teeth": (exported("bracket"), GivenData(teeth=("FACE MILL 63MM=9",)), teeth_of, 9.0),
        "depth": (flat, depth, depth_of, 7.5),
    }


@pytest.mark.parametrize("name", ["teeth", "depth"])
def test_given_data_are_read_and_written_in_place_as_ap238(name: str) -> None:
    data, words, value, wanted = cases()[name]
    whole = completed(Program(read(data)), words)
    assert value(whole.program) == wanted
    program = written(whole)
    assert is_aim(read(program.source.data))
    assert value(program) == wanted


@pytest.mark.parametrize("name", ["teeth", "depth"])
def test_withdrawn_data_leave_every_instance_as_it_was(name: str) -> None:
    data, words, _, _ = cases()[name]
    whole = completed(Program(read(data)), words)
    assert instances(without_given(written(whole), whole.given)) == instances(data)


def test_a_feed_is_given_to_the_public_example_in_its_own_unit() -> None:
    data = public(MILLING)
    whole = completed(Program(read(data)), GivenData(feed=FEED))
    program = written(whole)
    assert feed_of(whole.program) == feed_of(program) == pytest.approx(4.0, rel=1e-12)
    left = without_given(program, whole.given)
    kept, before = instances(left), instances(data)
    # The measures were there without a number; a feed that is withdrawn leaves none.
    assert before.keys() - kept.keys() == {*range(3821, 3825), *range(4121, 4125)}
    assert all(before[id] == text for id, text in kept.items())
    assert feed_is_missing(Program(read(left)))


def test_messages_name_the_instances_of_the_file() -> None:
    data, words, _, _ = cases()["depth"]
    program = completed(Program(read(data)), words).program
    ref = program.workingsteps[0].ref
    assert program.line(ref) == read(data).line(int(ref))


def test_what_the_file_has_is_not_set() -> None:
    data = exported("bracket")
    words = GivenData(values=(f"#{first_feature(data)}.depth=7.5",))
    with pytest.raises(SchemaError, match=r"depth: is in the file: only what an AP238"):
        completed(Program(read(data)), words)


def feed_is_missing(program: Program) -> bool:
    """Whether the fourth workingstep has no feed."""
    technology = program.get(program.workingsteps[3].technology_ref)
    return technology.feedrate is None  # type: ignore[attr-defined]
