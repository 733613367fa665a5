"""B-splines against polynomials worked out by hand."""

from math import hypot

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.spline import Spline, spline_of
from tests.every_case import every_case

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)


def read(curve: str) -> Spline:
    text = (
        f"{HEADER}#10={curve};\n"
        "#11=CARTESIAN_POINT('',(0.,0.,0.));\n#12=CARTESIAN_POINT('',(1.,2.,0.));\n"
        "#13=CARTESIAN_POINT('',(2.,0.,0.));\n#14=CARTESIAN_POINT('',(3.,0.,6.));\n"
        "ENDSEC;\nEND-ISO-10303-21;\n"
    )
    return spline_of(Program(Part21File.from_bytes(text.encode())), Ref(10))


FORM = ".UNSPECIFIED.,.F.,.F."
PARABOLA = f"B_SPLINE_CURVE('',2,(#11,#12,#13),{FORM})"


@given(part=st.floats(0.0, 1.0))
def test_three_points_of_degree_two_are_a_parabola(part: float) -> None:
    """Bernstein: x = 2t(1−t) + 2t² = 2t, y = 4t(1−t)."""
    x, y, z = read(PARABOLA).at(part)
    assert (x, y, z) == pytest.approx((2.0 * part, 4.0 * part * (1.0 - part), 0.0))


def test_without_knots_it_is_open_and_uniform() -> None:
    spline = read(f"B_SPLINE_CURVE('',2,(#11,#12,#13,#14),{FORM})")
    assert spline.knots == (0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0)
    assert spline.spans == (0.0, 1.0, 2.0)
    assert spline.at(0.0) == (0.0, 0.0, 0.0)
    assert spline.at(1.0) == (1.5, 1.0, 0.0)
    assert spline.at(2.0) == (3.0, 0.0, 6.0)


def test_knots_of_the_file_count_by_their_multiplicity() -> None:
    spline = read(
        f"B_SPLINE_CURVE_WITH_KNOTS('',1,(#11,#12,#13),{FORM},(2,1,2),(0.,3.,4.),.UNSPECIFIED.)"
    )
    assert spline.spans == (0.0, 3.0, 4.0)
    assert spline.at(1.5) == (0.5, 1.0, 0.0)
    assert spline.at(3.5) == (1.5, 1.0, 0.0)


def rational(weights: str, points: str = "#11,#12,#13") -> str:
    return (
        f"(BOUNDED_CURVE()B_SPLINE_CURVE(2,({points}),{FORM})"
        "B_SPLINE_CURVE_WITH_KNOTS((3,3),(0.,1.),.UNSPECIFIED.)CURVE()"
        f"GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE(({weights}))"
        "REPRESENTATION_ITEM(''))"
    )


@given(part=st.floats(0.0, 1.0))
def test_a_rational_parabola_is_a_circle(part: float) -> None:
    """Piegl and Tiller, section 7.3: the middle weight is the cosine of half the arc's angle.

    The tangents at the ends of (0, 0), (1, 2), (2, 0) meet at an angle whose half has the
    sine 1 / √5; the circle about (1, −0.5) has the radius √1.25.
    """
    x, y, z = read(rational(f"1.,{5.0**-0.5!r},1.")).at(part)
    assert hypot(x - 1.0, y + 0.5) == pytest.approx(1.25**0.5)
    assert z == 0.0


@pytest.mark.parametrize(
    ("weights", "message"),
    [("1.,1.", "2 weights for 3 control points"), ("1.,0.,1.", "weight 0: must be positive")],
)
def test_weights_that_cannot_be_meant(weights: str, message: str) -> None:
    with pytest.raises(PathError, match=message):
        read(rational(weights))


def test_a_point_may_be_a_complex_instance() -> None:
    point = (
        "(CARTESIAN_POINT((1.,2.,0.))GEOMETRIC_REPRESENTATION_ITEM()POINT()"
        "REPRESENTATION_ITEM(''))"
    )
    text = f"{PARABOLA.replace('#12', '#15')};\n#15={point}"
    assert read(text).at(0.5) == read(PARABOLA).at(0.5)


@every_case(
    ("curve", "message"),
    [
        (
            f"B_SPLINE_CURVE('',3,(#11,#12,#13),{FORM})",
            "degree 3 does not suit 3 control points",
        ),
        (f"B_SPLINE_CURVE('',0,(#11,#12),{FORM})", "degree 0"),
        (
            f"B_SPLINE_CURVE_WITH_KNOTS('',1,(#11,#12),{FORM},(2,1),(0.,1.),.UNSPECIFIED.)",
            "3 knots do not match 2 control points of degree 1",
        ),
        (
            f"B_SPLINE_CURVE_WITH_KNOTS('',1,(#11,#12),{FORM},(2,2),(1.,0.),.UNSPECIFIED.)",
            "the knots decrease: each must be at least the previous",
        ),
        (
            f"B_SPLINE_CURVE_WITH_KNOTS('',1,(#11,#12),{FORM},(4),(0.,1.),.UNSPECIFIED.)",
            "2 knots but 1 multiplicities",
        ),
        ("POLYLINE('',(#11,#12))", "is not a B-spline curve"),
    ],
)
def test_what_does_not_fit_together_is_refused(curve: str, message: str) -> None:
    with pytest.raises(PathError, match=message):
        read(curve)
