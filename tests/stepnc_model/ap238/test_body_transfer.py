"""Bodies are copied as they stand, under other numbers."""

from stepnc_model.ap238.body_transfer import BODY, body_entities, carried, with_bodies
from stepnc_model.part21.reader import Part21File
from tests.stepnc_model.ap238.long_form import schema
from tests.stepnc_model.ap238.samples import long_form

HEAD = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
    "FILE_SCHEMA(('A'));\nENDSEC;\nDATA;\n"
)
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"
SOURCE = f"""{HEAD}#1={BODY}('part',(#2),#9);
#2=MANIFOLD_SOLID_BREP('is #3, not #4',#3);
#3=CLOSED_SHELL('',/* see #1 */(#5));
#5=ADVANCED_FACE('',
  (),#6,.T.);
#6=PLANE('',$);
#9=(GEOMETRIC_REPRESENTATION_CONTEXT(3)REPRESENTATION_CONTEXT('#2',''));
#10=PLANE('of no body',$);
{TAIL}"""
TARGET = f"""{HEAD}#7={BODY}('part',(),$);
#8=PLANE('',$);
{TAIL}"""


def file(text: str) -> Part21File:
    return Part21File.from_bytes(text.encode())


def test_instances_keep_their_bytes_but_for_their_numbers() -> None:
    bodies = carried(file(SOURCE), [(1, 7)])
    assert (bodies.ids, bodies.findings) == ((2, 3, 5, 6, 9), ())
    made = with_bodies(TARGET.encode(), bodies).decode()
    assert (
        made
        == f"""{HEAD}#7={BODY}('part',(#9),#13);
#8=PLANE('',$);
#9=MANIFOLD_SOLID_BREP('is #3, not #4',#10);
#10=CLOSED_SHELL('',/* see #1 */(#11));
#11=ADVANCED_FACE('',
  (),#12,.T.);
#12=PLANE('',$);
#13=(GEOMETRIC_REPRESENTATION_CONTEXT(3)REPRESENTATION_CONTEXT('#2',''));
{TAIL}"""
    )


def test_what_two_bodies_share_is_copied_once() -> None:
    second = f"#11={BODY}('raw',(#2),#9);\n"
    source = SOURCE.replace(TAIL, second + TAIL)
    target = TARGET.replace(TAIL, f"#12={BODY}('raw',(),$);\n{TAIL}")
    made = with_bodies(target.encode(), carried(file(source), [(1, 7), (11, 12)])).decode()
    assert made.count("MANIFOLD_SOLID_BREP") == 1
    assert f"#7={BODY}('part',(#13),#17)" in made
    assert f"#12={BODY}('raw',(#13),#17)" in made


def test_a_damaged_body_is_left_out() -> None:
    for old, new, told in (
        ("#6=PLANE", "#66=PLANE", "#6 does not exist"),
        ("ADVANCED_FACE('',", "ADVANCED_FACE('',,", "line 11"),
        ("CLOSED_SHELL", "OPEN_SHELL", "ISO 10303-514 has no OPEN_SHELL"),
    ):
        bodies = carried(file(SOURCE.replace(old, new)), [(1, 7)])
        assert with_bodies(TARGET.encode(), bodies).decode() == TARGET
        [finding] = bodies.findings
        assert told in finding.message
        assert finding.entity == f"#1 {BODY}"


def test_an_empty_body_stays_empty() -> None:
    bodies = carried(file(SOURCE.replace("(#2)", "()")), [(1, 7)])
    assert (bodies.places, bodies.findings) == ((), ())


def test_the_entities_are_those_of_the_long_form() -> None:
    known = {name.upper() for name in schema(long_form()).supertypes}
    assert body_entities() - known == set()
