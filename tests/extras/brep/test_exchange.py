"""What Open CASCADE gets of a file: no comments, and only what a solid needs."""

from extras.brep.solid import exchange_below, whole_exchange
from stepnc_model.part21.reader import Part21File

TEXT = b"""ISO-10303-21;
HEADER;
FILE_SCHEMA(('MACHINING_SCHEMA'));
ENDSEC;
DATA;
/* #1=OLD('; */
#7=ADVANCED_BREP_SHAPE_REPRESENTATION('it''s /* no comment */',(#3),#9); /* end */
#3=MANIFOLD_SOLID_BREP('',/* of #8 */#5);
#5=CLOSED_SHELL('',());
#8=WORKINGSTEP('#5',$);
#9=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#99)));
#10=LENGTH_UNIT(LENGTH_MEASURE(1.),TYPED(#7));
ENDSEC;
END-ISO-10303-21;
"""
FILE = Part21File.from_bytes(TEXT, name="part.step")


def test_a_solid_is_taken_with_all_that_it_refers_to() -> None:
    found = exchange_below(FILE, 7)
    assert found.ids == (3, 5, 7, 9, 10)
    again = Part21File.from_bytes(found.data)
    assert tuple(again.ids()) == found.ids
    for id in found.ids:
        assert again.parts(id) == FILE.parts(id)
    assert b"WORKINGSTEP" not in found.data
    assert exchange_below(FILE, 3).ids == (3, 5)


def test_the_whole_file_keeps_its_order_but_no_comment() -> None:
    found = whole_exchange(FILE)
    assert found.ids == tuple(FILE.ids()) == (7, 3, 5, 8, 9, 10)
    assert found.data.count(b"/*") == 1
    again = Part21File.from_bytes(found.data)
    assert again.parameters(7)[0] == FILE.parameters(7)[0]
    assert tuple(again.ids()) == found.ids
