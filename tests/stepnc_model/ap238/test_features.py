"""Compound features, patterns and channels go to AP238 and back, with every number."""

import re

from stepnc_model.ap238.export import to_ap238
from stepnc_model.ap238.view import AimView
from stepnc_model.entities.features import CompoundFeature, ReplicateFeature
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from tests.every_case import every_case
from tests.stepnc_model.ap238.long_form import deviations, schema
from tests.stepnc_model.ap238.samples import Comparison, long_form, own, read
from tests.stepnc_model.ap238.test_reading import NAMED, paths, shape

HOLE = re.compile(rb"(=MACHINING_WORKINGSTEP\('[^']*',#\d+,)#160")
OPERATIONS = b"=ROUND_HOLE('HOLE 1',#30,(#210,#212,#214)"
COMMON = """
#9001=CARTESIAN_POINT('',(7.,3.5,0.));
#9002=AXIS2_PLACEMENT_3D('PLACE',#9001,$,$);
#9003=DIRECTION('',(1.,0.,0.));
#9004=DIRECTION('',(0.,1.,0.));
#9005=TOLERANCED_LENGTH_MEASURE(13.25,$);
#9006=TOLERANCED_LENGTH_MEASURE(7.75,$);
#9007=CARTESIAN_POINT('',(1.,2.,0.));
#9008=AXIS2_PLACEMENT_3D('FIRST',#9007,$,$);
#9009=CARTESIAN_POINT('',(11.,22.,0.));
#9010=AXIS2_PLACEMENT_3D('SECOND',#9009,$,$);
"""
SHARED = "'P',#30,(#210,#212,#214),#9002,#160,"
FEATURES = {
    "circle": f"CIRCULAR_PATTERN({SHARED}90.,3,(),(),$,7.5)",
    "wide circle": f"CIRCULAR_PATTERN({SHARED}36.5,2,(),(),#9005,0.)",
    "rows": f"RECTANGULAR_PATTERN({SHARED}#9005,#9003,2,3,#9006,#9004,(),())",
    "one row": f"RECTANGULAR_PATTERN({SHARED}#9005,#9003,$,2,$,$,(),())",
    "places": f"GENERAL_PATTERN({SHARED}(#9008,#9010))",
    "compound": "COMPOUND_FEATURE('C',#30,(),#9002,(#160,#170))",
    "counterbore": "COUNTERBORE_HOLE('C',#30,(),#9002,(#160))",
    "countersink": "COUNTERSUNK_HOLE('C',#30,(),#9002,(#160))",
}


def program(feature: str) -> Part21File:
    """The bracket with a further feature; a pattern takes the place of its first hole."""
    data = own("bracket").data
    if "PATTERN" in feature:
        data, count = HOLE.subn(rb"\1#9100", data)
        assert count == 3
        data = data.replace(OPERATIONS, OPERATIONS.partition(b"#210")[0] + b")")
    head, mark, tail = data.rpartition(b"ENDSEC;")
    return read(head + f"{COMMON}#9100={feature};\n".encode() + mark + tail)


@every_case("name", FEATURES)
def test_a_feature_goes_there_and_back(name: str) -> None:
    file = program(FEATURES[name])
    made = to_ap238(file)
    unused = [each for each in made.findings if "nothing that AP238" in each.message]
    assert list(made.findings) == unused
    there = read(made.data)
    assert list(deviations(there, schema(long_form()))) == []
    back = AimView.of(there)
    keyword = FEATURES[name].partition("(")[0]
    (one,), (other,) = file.ids_of(keyword), back.ids_of(keyword)
    comparison = Comparison(file, back)
    assert set(comparison.run()) <= NAMED
    assert set(comparison.between(one, other)) <= NAMED
    assert [shape(path) for path in paths(Program(file))] == [
        shape(path) for path in paths(Program(there))
    ]
    read_back = [
        each
        for kind in (CompoundFeature, ReplicateFeature)
        for each in Program(back).model.of_type(kind)
    ]
    assert len(read_back) == 1


THREAD = """
#9020=PARTIAL_AREA_DEFINITION(14.5,#9002,15.25);
#9021=DESCRIPTIVE_PARAMETER('fit class','6H');
#9022=DESCRIPTIVE_PARAMETER('form','M');
#9023=NUMERIC_PARAMETER('number of threads',0.5,'mm');
#9024=DESCRIPTIVE_PARAMETER('hand','right');
#9100=DEFINED_THREAD('T',#30,(),#9002,#163,#9020,(#160),.T.,$,#9021,#9022,12.,#9023,#9024,
  10.863,10.106,$);
"""


def test_a_thread_goes_there_and_back() -> None:
    head, mark, tail = own("bracket").data.rpartition(b"ENDSEC;")
    file = read(head + (COMMON + THREAD).encode() + mark + tail)
    made = to_ap238(file)
    assert {each.message for each in made.findings} <= {
        "nothing that AP238 expresses refers to it"
    }
    there = read(made.data)
    assert list(deviations(there, schema(long_form()))) == []
    back = AimView.of(there)
    (thread,) = back.ids_of("DEFINED_THREAD")
    comparison = Comparison(file, back)
    comparison.run()
    assert set(comparison.between(9100, thread)) <= NAMED
    values = [value for value in back.parameters(thread) if isinstance(value, float)]
    assert values == [12.0, 10.863, 10.106]


def test_a_compound_of_another_kind_is_read() -> None:
    data = to_ap238(program(FEATURES["counterbore"])).data
    assert b"'counterbore'" in data
    back = AimView.of(read(data.replace(b"'counterbore'", b"'stepped'")))
    (compound,) = back.ids_of("COMPOUND_FEATURE")
    assert back.label(compound).endswith(" COMPOUND_FEATURE")


def test_copies_that_are_moved_or_missing_are_listed() -> None:
    feature = "CIRCULAR_PATTERN('P',#30,(),#9002,#160,90.,3,(#9101),(#9102),$,0.)"
    text = f"{feature};\n#9101=CIRCULAR_OFFSET(5.,2);\n#9102=CIRCULAR_OMIT(3)"
    made = to_ap238(program(text))
    assert {each.attribute for each in made.findings} >= {
        "relocated_base_feature",
        "missing_base_feature",
    }


def test_the_channel_of_a_workplan_is_kept() -> None:
    data = own("bracket").data
    plan = data[data.index(b"WORKPLAN(") :].partition(b";")[0]
    assert plan.count(b",$,") >= 1
    changed = plan.replace(b"),$,", b"),#9001,", 1).replace(b",(#3,", b",(#9002,#3,", 1)
    assert b"#9002" in changed
    waiting = b"#9001=CHANNEL('LEFT');\n#9002=WAIT_FOR_MARK('WAIT',#9001);\n"
    head, mark, tail = data.replace(plan, changed).rpartition(b"ENDSEC;")
    made = to_ap238(read(head + waiting + mark + tail))
    assert made.findings == ()
    assert list(deviations(read(made.data), schema(long_form()))) == []
    back = AimView.of(read(made.data))
    (channel,) = back.ids_of("CHANNEL")
    assert back.parameters(channel) == ("LEFT",)
    (waits,) = back.ids_of("WAIT_FOR_MARK")
    assert back.parameters(waits) == ("WAIT", Ref(channel))
    main = next(
        id for id in back.ids_of("WORKPLAN") if str(Ref(waits)) in str(back.parameters(id)[1])
    )
    assert Ref(channel) in back.parameters(main)
