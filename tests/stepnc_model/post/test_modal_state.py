"""Feed, spindle and coolant as controls need them, from technologies of a file."""

from math import pi

import pytest

from stepnc_model.entities.entity import Entity
from stepnc_model.errors import PostError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.post.blocks import (
    CoolantKind,
    MachineType,
    Rate,
    RateMode,
    SpindleDirection,
    SpindleOff,
    SpindleOn,
    SurfaceSpeed,
)
from stepnc_model.post.modal_state import ModalState, conditions, constant_speed, coolant_of
from stepnc_model.programs.program import Program
from stepnc_model.toolpath.path import Feed
from tests.every_case import every_case

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
TOOLS = (
    "#10=MILLING_CUTTING_TOOL('MILL',#11,(),80.,$,$);\n"
    "#11=ENDMILL(#12,4,.{hand}.,.F.,$);\n"
    "#12=MILLING_TOOL_DIMENSION(10.,$,$,22.,0.,$,$);\n"
    "#20=GENERAL_TURNING_TOOL('TURN',150.,32.,$,$,$,#21,.RIGHT.);\n"
    "#21=CUTTING_EDGE_PROPERTIES($,$,12.,95.,$,80.,(),6.,$);\n"
)
MILL: Ref[Entity] = Ref(10)
TURN: Ref[Entity] = Ref(20)
TECHNOLOGY: Ref[Entity] = Ref(30)


def program(*instances: str, hand: str = "RIGHT") -> Program:
    body = "\n".join(instances)
    text = f"{HEADER}{TOOLS.format(hand=hand)}{body}\nENDSEC;\nEND-ISO-10303-21;\n"
    return Program(Part21File.from_bytes(text.encode()))


def milling(numbers: str, feed: Feed | None = None, *, hand: str = "RIGHT") -> ModalState:
    """Feedrate, reference, cutspeed, spindle and feed per tooth of a technology."""
    found = program(f"#30=MILLING_TECHNOLOGY({numbers},.F.,.F.,.F.,$);", hand=hand)
    return conditions(found, feed or Feed(technology=TECHNOLOGY), MILL, MachineType.MILL)


def turning(numbers: str, *instances: str, feed: Feed | None = None) -> ModalState:
    """Feedrate, reference, spindle speed and feed per revolution of a technology."""
    found = program(f"#30=TURNING_TECHNOLOGY({numbers},.F.,.F.,.F.,$);", *instances)
    return conditions(found, feed or Feed(technology=TECHNOLOGY), TURN, MachineType.LATHE)


class TestMilling:
    def test_a_negative_spindle_is_clockwise(self) -> None:
        found = milling("0.04,.TCP.,$,-12.,$")
        assert found == ModalState(spindle=SpindleOn(speed=12.0), rate=Rate(value=40.0))

    def test_a_positive_spindle_is_what_the_file_says_and_odd(self) -> None:
        found = milling("0.04,.TCP.,$,12.,$")
        assert found.spindle == SpindleOn(speed=12.0, sense=SpindleDirection.COUNTERCLOCKWISE)
        assert "counterclockwise with a right hand tool" in found.note

    def test_a_left_hand_tool_turns_the_other_way(self) -> None:
        assert not milling("0.04,.TCP.,$,12.,$", hand="LEFT").note
        found = milling("0.04,.TCP.,1.,$,$", hand="LEFT")
        assert isinstance(found.spindle, SpindleOn)
        assert found.spindle.sense is SpindleDirection.COUNTERCLOCKWISE

    def test_a_cutting_speed_becomes_a_spindle_speed(self) -> None:
        """π·10 mm at 1 m/s: 31.831 rev/s."""
        found = milling("0.04,.TCP.,1.,$,$")
        assert isinstance(found.spindle, SpindleOn)
        assert found.spindle.speed == pytest.approx(1000.0 / (10.0 * pi))
        assert found.spindle.sense is SpindleDirection.CLOCKWISE

    def test_feed_per_tooth_becomes_feed(self) -> None:
        """0.1 mm · 4 teeth · 20 rev/s."""
        rate = milling("$,.TCP.,$,-20.,0.1").rate
        assert rate is not None
        assert rate.mode is RateMode.PER_MINUTE
        assert rate.value == pytest.approx(8.0)

    def test_ratios_count(self) -> None:
        feed = Feed(technology=TECHNOLOGY, ratio=0.5, speed_ratio=2.0)
        found = milling("0.04,.TCP.,$,-12.,$", feed)
        assert found == ModalState(spindle=SpindleOn(speed=24.0), rate=Rate(value=20.0))

    def test_a_velocity_of_its_own_wins(self) -> None:
        feed = Feed(technology=TECHNOLOGY, velocity=7.0, ratio=0.5)
        assert milling("0.04,.TCP.,$,-12.,$", feed).rate == Rate(value=7.0)

    def test_the_lead_of_a_tap_is_feed_over_speed(self) -> None:
        """12.5 mm/s at 10 rev/s."""
        feed = Feed(technology=TECHNOLOGY, is_synchronised=True)
        assert milling("0.0125,.TCP.,$,-10.,$", feed).lead == pytest.approx(1.25)

    def test_a_lead_of_its_own_wins(self) -> None:
        feed = Feed(technology=TECHNOLOGY, per_revolution=1.5, is_synchronised=True)
        found = milling("0.0125,.TCP.,$,-10.,$", feed)
        assert (found.lead, found.rate) == (1.5, Rate(value=15.0))


class TestMissingNumbers:
    def test_a_spindle_speed_of_zero_is_a_standing_spindle(self) -> None:
        """As #420 of NIST's ex1E.stp, which stops the spindle in a reamed hole."""
        found = milling("0.03,.TCP.,$,0.0,$")
        assert (found.spindle, found.rate) == (SpindleOff(), Rate(value=30.0))
        assert found.note == "#30 MILLING_TECHNOLOGY: spindle speed 0: the spindle is stopped"

    def test_a_missing_feed_leaves_the_spindle(self) -> None:
        found = milling("$,.TCP.,$,-8.,$")
        assert (found.spindle, found.rate) == (SpindleOn(speed=8.0), None)
        assert "WR2" in found.note

    def test_a_missing_feed_is_replaced_by_a_velocity(self) -> None:
        feed = Feed(technology=TECHNOLOGY, velocity=7.0)
        assert milling("$,.TCP.,$,-8.,$", feed).rate == Rate(value=7.0)

    def test_a_missing_speed_leaves_the_feed(self) -> None:
        found = milling("0.03,.TCP.,$,$,$")
        assert (found.spindle, found.rate) == (None, Rate(value=30.0))
        assert "WR1" in found.note

    def test_a_cutting_speed_needs_a_tool(self) -> None:
        found = program("#30=MILLING_TECHNOLOGY(0.03,.TCP.,1.,$,$,.F.,.F.,.F.,$);")
        with pytest.raises(PostError, match=r"#30 MILLING_TECHNOLOGY: .*diameter"):
            conditions(found, Feed(technology=TECHNOLOGY), None, MachineType.MILL)


class TestTurning:
    CONSTANT = "#31=CONST_SPINDLE_SPEED(12.5);"
    SURFACE = "#31=CONST_CUTTING_SPEED(2.5,50.);"

    def test_a_positive_spindle_is_m3(self) -> None:
        found = turning("$,.TCP.,#31,0.2", self.CONSTANT)
        rate = Rate(value=0.2, mode=RateMode.PER_REVOLUTION)
        assert found == ModalState(spindle=SpindleOn(speed=12.5), rate=rate)

    def test_a_negative_spindle_is_m4(self) -> None:
        found = turning("$,.TCP.,#31,0.2", "#31=CONST_SPINDLE_SPEED(-12.5);")
        assert found.spindle == SpindleOn(speed=12.5, sense=SpindleDirection.COUNTERCLOCKWISE)

    def test_a_cutting_speed_stays_one_with_its_limit(self) -> None:
        found = turning("$,.TCP.,#31,0.2", self.SURFACE)
        assert found.spindle == SurfaceSpeed(speed=2500.0, limit=50.0)

    def test_a_feedrate_is_per_minute(self) -> None:
        assert turning("0.002,.TCP.,#31,$", self.SURFACE).rate == Rate(value=2.0)

    def test_a_thread_needs_a_pitch(self) -> None:
        feed = Feed(technology=TECHNOLOGY, is_synchronised=True)
        assert turning("$,.TCP.,#31,2.", self.SURFACE, feed=feed).lead == 2.0
        with pytest.raises(PostError, match="needs a feed per revolution or a spindle speed"):
            turning("0.002,.TCP.,#31,$", self.SURFACE, feed=feed)


class TestConstantSpeed:
    def test_it_falls_with_the_radius(self) -> None:
        """1500 mm/s on a circumference of 30π mm."""
        found = constant_speed(SurfaceSpeed(speed=1500.0), 15.0)
        assert found.speed == pytest.approx(1500.0 / (30.0 * pi))

    def test_it_keeps_its_limit(self) -> None:
        assert constant_speed(SurfaceSpeed(speed=1500.0, limit=10.0), 15.0).speed == 10.0
        assert constant_speed(SurfaceSpeed(speed=1500.0, limit=10.0), 0.0).speed == 10.0

    def test_on_the_axis_it_needs_a_limit(self) -> None:
        with pytest.raises(PostError, match="needs a spindle speed limit"):
            constant_speed(SurfaceSpeed(speed=1500.0), 0.0)


@every_case(
    ("instance", "kinds"),
    [
        ("MILLING_MACHINE_FUNCTIONS(.T.,$,$,.F.,$,(),.T.,$,$,())", {CoolantKind.FLOOD}),
        ("MILLING_MACHINE_FUNCTIONS(.F.,$,.T.,.F.,$,(),.T.,$,$,())", {CoolantKind.MIST}),
        ("MILLING_MACHINE_FUNCTIONS(.F.,$,$,.T.,$,(),.T.,$,$,())", {CoolantKind.THROUGH}),
        ("MILLING_MACHINE_FUNCTIONS(.F.,$,$,.F.,$,(),.T.,$,$,())", set()),
        ("TURNING_MACHINE_FUNCTIONS(.T.,$,$,(),.T.,$,$,(),.F.,.F.,.F.)", {CoolantKind.FLOOD}),
        (
            "TURNING_MACHINE_FUNCTIONS(.T.,.MIST.,$,(),.T.,$,$,(),.F.,.F.,.F.)",
            {CoolantKind.MIST},
        ),
        ("TURNING_MACHINE_FUNCTIONS(.F.,.MIST.,$,(),.T.,$,$,(),.F.,.F.,.F.)", set()),
    ],
)
def test_coolant_is_what_the_functions_ask_for(instance: str, kinds: set[CoolantKind]) -> None:
    assert coolant_of(program(f"#40={instance};"), Ref(40)).kinds == kinds
