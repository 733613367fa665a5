"""What the service refuses: one tree, fields that a program can read."""

from service import errors
from service.errors import NotFound, ServiceError, TooLarge, TooMany
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

KINDS = [
    kind
    for kind in vars(errors).values()
    if isinstance(kind, type) and issubclass(kind, ServiceError)
]


@every_case("kind", KINDS)
def test_each_is_of_the_projects_tree_and_drawn_in_the_docstring(kind: type) -> None:
    assert issubclass(kind, StepNcError)
    assert errors.__doc__ is not None
    assert kind.__name__ in errors.__doc__


def test_messages_name_thing_bound_and_unit() -> None:
    assert str(NotFound("program", "x")) == "there is no program 'x'"
    assert str(TooLarge("the body", bound=10)).endswith("10 bytes, the largest size accepted")
    assert str(TooMany(1.25)) == "too many requests: try again in 1.2 s"


def test_fields_are_there_for_programs() -> None:
    missing = NotFound("program", "x")
    assert (missing.thing, missing.id) == ("program", "x")
    assert (TooLarge("a", bound=10).bound, TooMany(1.5).wait) == (10, 1.5)
