"""Data that an AP238 file lacks, given by the user: it stays a file of AP238."""

from collections.abc import Callable
from functools import cache
from typing import Any

import pytest

from stepnc_model.ap238.export import to_ap238
from stepnc_model.ap238.view import AimView, is_aim
from stepnc_model.ap238.writing import spliced_into
from stepnc_model.editing.draft import Draft
from stepnc_model.editing.user_data import Completed, GivenData, GivenFeed, completed
from stepnc_model.editing.withdrawal import without_user_data
from stepnc_model.entities.executables import Setup
from stepnc_model.entities.features import RoundHole, Step
from stepnc_model.entities.geometry import Block, CartesianPoint
from stepnc_model.errors import SchemaError, Severity
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed
from stepnc_model.programs.tool import tool_of
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
    assert instances(without_user_data(written(whole), whole)) == instances(data)


def test_a_feed_is_given_to_the_public_example_in_its_own_unit() -> None:
    data = public(MILLING)
    whole = completed(Program(read(data)), GivenData(feed=FEED))
    program = written(whole)
    assert feed_of(whole.program) == feed_of(program) == pytest.approx(4.0, rel=1e-12)
    left = without_user_data(program, whole)
    # The measures were there without a number, and are so again.
    assert instances(left) == instances(data)
    assert feed_is_missing(Program(read(left)))


def test_messages_name_the_instances_of_the_file() -> None:
    data, words, _, _ = cases()["depth"]
    program = completed(Program(read(data)), words).program
    ref = program.workingsteps[0].ref
    assert program.line(ref) == read(data).line(int(ref))


class TestWhatTheFileHas:
    """Values that the file gives are replaced where they stand, and put back."""

    @pytest.mark.parametrize(
        ("feature", "attribute", "value", "added"),
        [
            (Step, "depth", "7.5", 0),
            (RoundHole, "depth", "7.5", 3),
            (RoundHole, "diameter", "11.5", 1),
        ],
    )
    def test_a_number_is_replaced(
        self, feature: type[Step | RoundHole], attribute: str, value: str, added: int
    ) -> None:
        """The step has a plane of its own; two holes share their plane and their measure."""
        data = exported("bracket")
        number = int(next(ref for ref, _ in Program(read(data)).model.of_type(feature)))
        whole = completed(
            Program(read(data)), GivenData(values=(f"#{number}.{attribute}={value}",))
        )
        program = written(whole)
        for each in (whole.program, program):
            hole: Any = each.model.get(Ref(number))
            found = (
                each.get(each.get(each.get(hole.depth).position).location).coordinates[2]
                if attribute == "depth"
                else -each.get(hole.diameter).theoretical_size
            )
            assert found == -float(value)
        after = instances(program.source.data)
        assert sum(after[id] != text for id, text in instances(data).items()) == 1
        assert len(after) - len(instances(data)) == added
        left = instances(without_user_data(program, whole))
        assert all(left[id] == text for id, text in instances(data).items())

    def test_a_reference_is_replaced(self) -> None:
        data = exported("bracket")
        program = Program(read(data))
        first, last = program.workingsteps[0], program.workingsteps[-1]
        words = (
            f"{first.operation_ref}.its_tool={last.tool_ref}",
            f"{last.ref}.its_feature={first.features[0]}",
        )
        whole = completed(program, GivenData(values=words))
        found = written(whole)
        assert found.workingsteps[0].tool_ref == last.tool_ref
        assert found.workingsteps[-1].features == first.features
        left = Program(read(without_user_data(found, whole)))
        assert left.workingsteps[0].tool_ref == first.tool_ref
        assert left.workingsteps[-1].features == last.features
        texts = instances(left.source.data)
        assert texts.keys() == instances(data).keys()
        # Tools list their users, in no order.
        differing = {id for id, text in instances(data).items() if texts[id] != text}
        assert all(b"MACHINING_TOOL" in texts[id] for id in differing)

    def test_the_number_of_a_tool_stands_for_its_body_too(self) -> None:
        data = exported("bracket")
        tool = Program(read(data)).workingsteps[0].tool_ref
        whole = completed(Program(read(data)), GivenData(values=(f"{tool}.number_of_teeth=9",)))
        assert teeth_of(whole.program) == teeth_of(written(whole)) == 9.0

    def test_what_ap238_cannot_say_is_refused_and_not_lost(self) -> None:
        data = exported("bracket")
        (block,) = Program(read(data)).model.of_type(Block)
        ((_, setup),) = list(Program(read(data)).model.of_type(Setup))[:1]
        place = setup.its_origin
        words = GivenData(values=(f"{block[0]}.position={place}",))
        with pytest.raises(SchemaError, match=r"BLOCK.position: cannot be written into an AP"):
            written(completed(Program(read(data)), words))


def feed_is_missing(program: Program) -> bool:
    """Whether the fourth workingstep has no feed."""
    technology = program.get(program.workingsteps[3].technology_ref)
    return technology.feedrate is None  # type: ignore[attr-defined]


def test_a_reference_that_leads_nowhere_is_told_and_can_be_mended() -> None:
    """The missing point is the reason, not a security plane, which is read as not given."""
    data = exported("bracket")
    program = Program(read(data))
    hole: Any = program.get(program.workingsteps[-1].features[0])
    place: Any = program.model.get(hole.feature_placement)
    text = instances(data)[int(place.location)]
    broken = Program(read(data.replace(text, b"")))
    step = broken.workingsteps[-1]
    with (
        pytest.raises(SchemaError, match=rf"location: {place.location} does not exist in"),
        broken.using(step.ref, step.features[0]),
    ):
        raise AttributeError
    other = next(ref for ref, _ in broken.model.of_type(CartesianPoint))
    words = GivenData(values=(f"{hole.feature_placement}.location={other}",))
    mended = completed(broken, words).program
    assert Severity.ERROR in {each.severity for each in broken.file.findings}
    assert Severity.ERROR not in {each.severity for each in mended.file.findings}
