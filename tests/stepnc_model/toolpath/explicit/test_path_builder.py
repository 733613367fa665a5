"""Explicit tool paths one after another: gaps, connectors and pauses.

Security plane at z = 30 mm; where there is a raw part it reaches from 0 to 100 mm in x and y,
and from −20 to 0 mm in z. A tool of 10 mm.
"""

import pytest

from stepnc_model.errors import PathError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program, Stock
from stepnc_model.programs.tool import Tool
from stepnc_model.toolpath.explicit.path_builder import ExplicitPathBuilder, PathSurroundings
from stepnc_model.toolpath.frame import Frame
from stepnc_model.toolpath.path import Dwell, Move

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
COMMON = (
    "#10=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,#20,$,$);",
    "#11=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,#21,$,$);",
    "#12=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,#22,$,$);",
    "#13=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,$,$,#23,$,$);",
    "#20=POLYLINE('',(#30,#31));",
    "#21=POLYLINE('',(#32,#33));",
    "#22=POLYLINE('',(#34,#33));",
    "#23=POLYLINE('',(#35,#36));",
    "#30=CARTESIAN_POINT('',(10.,10.,-5.));",
    "#31=CARTESIAN_POINT('',(20.,10.,-5.));",
    "#32=CARTESIAN_POINT('',(20.,10.5,-5.));",
    "#33=CARTESIAN_POINT('',(40.,10.5,-5.));",
    "#34=CARTESIAN_POINT('',(30.,30.,-5.));",
    "#35=CARTESIAN_POINT('',(-5.,30.,-5.));",
    "#36=CARTESIAN_POINT('',(10.,30.,-5.));",
    "#40=CONNECT_SECPLANE(.T.,.CONNECT.,$,$,$,$,$);",
    "#41=CONNECT_DIRECT(.T.,.CONNECT.,$,$,$);",
    "#42=CONNECT_DIRECT(.T.,.CONNECT.,.RAPID.,$,$);",
    "#43=CONNECT_SECPLANE(.T.,.CONNECT.,$,$,$,#50,#51);",
    "#44=FEEDSTOP(.T.,.CONTACT.,$,$,$,1.5);",
    "#45=FEEDSTOP(.T.,.CONTACT.,$,$,$,0.);",
    "#46=CUTTER_LOCATION_TRAJECTORY(.T.,.CONTACT.,$,$,#60,$,#20,$,$);",
    "#47=AP_LIFT_PATH_ANGLE(.T.,.APPROACH.,$,$,$,#48,$,45.,3.);",
    "#48=CARTESIAN_POINT('',(10.,10.,20.));",
    "#49=AP_LIFT_PATH_ANGLE(.T.,.LIFT.,$,$,$,#48,$,45.,3.);",
    "#50=DIRECTION('',(1.,0.,1.));",
    "#51=DIRECTION('',(0.,-1.,-1.));",
    "#60=MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,());",
)
STOCK = Stock(low=(0.0, 0.0, -20.0), high=(100.0, 100.0, 0.0))


def walked(
    *paths: int, stock: Stock | None = STOCK, technology: int | None = 9
) -> ExplicitPathBuilder:
    text = f"{HEADER}{chr(10).join(COMMON)}\nENDSEC;\nEND-ISO-10303-21;\n"
    walk = ExplicitPathBuilder(
        PathSurroundings(
            program=Program(Part21File.from_bytes(text.encode())),
            security_z=30.0,
            stock=stock,
            tool=lambda: Tool(id="T", keyword="ENDMILL", diameter=10.0),
            technology=None if technology is None else Ref(technology),
        )
    )
    walk.follow([Ref(path) for path in paths], Frame())
    return walk


def shown(walk: ExplicitPathBuilder) -> list[tuple[float, ...] | str]:
    """Ends of the moves, rapid ones marked."""
    lines: list[tuple[float, ...] | str] = []
    for step in walk.steps:
        if isinstance(step, Move):
            lines += [step.end] if step.feed else ["rapid", step.end]
    return lines


def test_it_starts_where_the_first_trajectory_does() -> None:
    walk = walked(10)
    assert (walk.start, walk.at) == ((10.0, 10.0, -5.0), (20.0, 10.0, -5.0))


class TestGap:
    def test_a_short_one_is_closed_straight(self) -> None:
        assert shown(walked(10, 11)) == [
            (20.0, 10.0, -5.0),
            (20.0, 10.5, -5.0),
            (40.0, 10.5, -5.0),
        ]

    def test_a_long_one_is_passed_over_the_security_plane(self) -> None:
        """Down in rapid to 5 mm above the raw part, then at feed."""
        assert shown(walked(10, 12))[1:-1] == [
            "rapid",
            (20.0, 10.0, 30.0),
            "rapid",
            (30.0, 30.0, 30.0),
            "rapid",
            (30.0, 30.0, 5.0),
            (30.0, 30.0, -5.0),
        ]

    def test_beside_the_raw_part_rapid_goes_all_the_way_down(self) -> None:
        assert shown(walked(10, 13))[-3:-1] == ["rapid", (-5.0, 30.0, -5.0)]

    def test_where_the_raw_part_is_not_known_feed_goes_all_the_way_down(self) -> None:
        assert shown(walked(10, 13, stock=None))[3:-1] == [
            "rapid",
            (-5.0, 30.0, 30.0),
            (-5.0, 30.0, -5.0),
        ]

    def test_a_rapid_movement_passes_it_in_rapid(self) -> None:
        lines = shown(walked(10, 12, technology=None))
        assert lines[::2] == ["rapid"] * (len(lines) // 2)


class TestConnector:
    def test_over_the_security_plane(self) -> None:
        assert shown(walked(10, 40, 12)) == shown(walked(10, 12))

    def test_over_the_security_plane_first_starts_above_the_cut(self) -> None:
        walk = walked(40, 12)
        assert walk.start == (30.0, 30.0, 30.0)
        assert shown(walk)[0] == "rapid"

    def test_over_the_security_plane_last_ends_on_it(self) -> None:
        assert walked(10, 40).at == (20.0, 10.0, 30.0)

    def test_it_rises_and_sinks_along_its_directions(self) -> None:
        """35 mm up and 35 mm in x; down 35 mm from 35 mm in y."""
        lines = [line for line in shown(walked(10, 43, 12)) if line != "rapid"]
        assert lines[1:3] == [
            pytest.approx((55.0, 10.0, 30.0)),
            pytest.approx((30.0, 65.0, 30.0)),
        ]
        assert lines[3] == pytest.approx((30.0, 40.0, 5.0))

    def test_straight_at_feed(self) -> None:
        assert shown(walked(10, 41, 12))[1] == (30.0, 30.0, -5.0)

    def test_straight_in_rapid_where_it_says_so(self) -> None:
        assert shown(walked(10, 42, 12))[1:3] == ["rapid", (30.0, 30.0, -5.0)]

    def test_a_pause_does_not_hide_where_it_leads(self) -> None:
        assert shown(walked(10, 41, 44, 12)) == shown(walked(10, 41, 12))


def test_a_pause_is_a_dwell() -> None:
    assert walked(10, 44).steps[-1] == Dwell(seconds=1.5)


def test_a_pause_without_length_is_refused() -> None:
    with pytest.raises(PathError, match=r"#45 FEEDSTOP: dwell 0 s"):
        walked(10, 45)


def test_functions_of_a_single_tool_path_are_said_to_be_left_out() -> None:
    (finding,) = walked(46, 46).findings
    assert "machine functions" in finding.message


def test_an_approach_leads_to_the_cut_that_follows() -> None:
    """45 degrees, 3 mm before the cut, which runs along x."""
    walk = walked(47, 10)
    assert walk.start == (10.0, 10.0, 20.0)
    part = 3.0 * 0.5**0.5
    assert shown(walk)[0] == pytest.approx((10.0 - part, 10.0, -5.0 + part))
    assert shown(walk)[1] == pytest.approx((10.0, 10.0, -5.0))


def test_a_lift_leads_away_from_the_last_cut() -> None:
    walk = walked(10, 49)
    part = 3.0 * 0.5**0.5
    assert shown(walk)[1] == pytest.approx((20.0 + part, 10.0, -5.0 + part))
    assert walk.at == (10.0, 10.0, 20.0)


def test_an_approach_to_nothing_is_refused() -> None:
    with pytest.raises(PathError, match="there is no trajectory to approach or leave"):
        walked(10, 47)
