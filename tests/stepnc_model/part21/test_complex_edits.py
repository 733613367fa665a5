"""Edits within complex instances, and new complex instances."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Enumeration, Real, Ref, Typed
from stepnc_model.part21.writer import Edits

COMPLEX = (
    b"#7=(\nLENGTH_MEASURE_WITH_UNIT()\nMEASURE_WITH_UNIT( LENGTH_MEASURE(2.5) /* mm */ ,#1)\n"
    b"REPRESENTATION_ITEM('a (b), c')\n);"
)


def file_of(*instances: bytes) -> Part21File:
    """File with some instances."""
    body = b"\n".join(instances)
    return Part21File.from_bytes(
        b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n" + body + b"\nENDSEC;\nEND-ISO-10303-21;\n"
    )


def test_a_parameter_of_one_part_is_replaced_and_the_rest_stays() -> None:
    edits = Edits(file_of(COMPLEX))
    edits.replace_in_part(7, 1, 0, Typed("LENGTH_MEASURE", Real(3.25)))
    edits.replace_in_part(7, 2, 0, "new")
    assert COMPLEX.replace(b"2.5", b"3.25").replace(b"a (b), c", b"new") in edits.apply()


def test_parts_without_parameters_count() -> None:
    file = file_of(COMPLEX)
    spans = file.part_spans(7)
    texts = [[file.data[a:b] for a, b in part] for part in spans]
    assert texts == [[], [b"LENGTH_MEASURE(2.5)", b"#1"], [b"'a (b), c'"]]


def test_a_simple_instance_has_one_part() -> None:
    edits = Edits(file_of(b"#1=CARTESIAN_POINT('',(0.,0.));"))
    edits.replace_in_part(1, 0, 0, "origin")
    assert b"#1=CARTESIAN_POINT('origin',(0.,0.));" in edits.apply()


def test_an_unknown_or_removed_instance_is_refused() -> None:
    edits = Edits(file_of(COMPLEX))
    edits.replace_in_part(7, 2, 0, "new")
    edits.remove(7)
    assert b"#7" not in edits.apply()
    for number in (7, 8):
        with pytest.raises(KeyError):
            edits.replace_in_part(number, 2, 0, "new")


def test_a_complex_instance_is_added_with_the_next_number() -> None:
    edits = Edits(file_of(COMPLEX))
    ref = edits.add_complex([
        ("LENGTH_UNIT", ()),
        ("SI_UNIT", (Enumeration("MILLI"), Enumeration("METRE"))),
    ])
    assert ref == Ref(8)
    assert b"#8=(LENGTH_UNIT()SI_UNIT(.MILLI.,.METRE.));" in edits.apply()


@given(st.floats(allow_nan=False, allow_infinity=False), st.text(max_size=20))
def test_what_is_written_into_a_part_is_read_from_it(number: float, text: str) -> None:
    edits = Edits(file_of(COMPLEX))
    edits.replace_in_part(7, 1, 0, Typed("LENGTH_MEASURE", Real(number)))
    edits.replace_in_part(7, 2, 0, text)
    parts = dict(Part21File.from_bytes(edits.apply()).parts(7))
    assert parts["MEASURE_WITH_UNIT"] == (Typed("LENGTH_MEASURE", Real(number)), Ref(1))
    assert parts["REPRESENTATION_ITEM"] == (text,)
