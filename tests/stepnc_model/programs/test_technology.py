"""What a technology programs, in mm, s and rev/s, and how a number is written back."""

from math import pi

import pytest

from stepnc_model.errors import SchemaError
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import Number, Programmed, ProgrammedQuantity, programmed
from stepnc_model.units import ISO, PROFILES, UnitProfile
from tests.every_case import every_case

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('MACHINING_SCHEMA'));\nENDSEC;\nDATA;\n"
    "#1=PROJECT('P',#2,(),$,$,$);\n#2=WORKPLAN('W',(),$,$,$);\n"
)
FIRST_LINE = 8
HOSTILE = ["0.", "-0.04", "1e400", "-1e400", "'fast'"]


def read(*instances: str, units: UnitProfile = ISO) -> Programmed:
    """Technology #10."""
    body = "\n".join(instances)
    text = f"{HEADER}{body}\nENDSEC;\nEND-ISO-10303-21;\n"
    return programmed(Program(Part21File.from_bytes(text.encode()), units=units), Ref(10))


def milling(
    feed: str = "0.04",
    cutspeed: str = "$",
    spindle: str = "-12.",
    per_tooth: str = "$",
    *,
    flags: str = ".F.,.F.,.F.",
    units: UnitProfile = ISO,
) -> Programmed:
    return read(
        f"#10=MILLING_TECHNOLOGY({feed},.TCP.,{cutspeed},{spindle},{per_tooth},{flags},$);",
        units=units,
    )


def adaptive(
    speed: str = "SPINDLE_SPEED(.T.,-12.)",
    feed: str = "FEEDRATE_TCP(.T.,0.04)",
    *,
    flags: str = ".F.,.F.,.F.",
    units: UnitProfile = ISO,
) -> Programmed:
    return read(
        f"#10=MILLING_TECHNOLOGY(#11,#12,{flags});",
        f"#11={speed};",
        f"#12={feed};",
        units=units,
    )


def turning(
    speed: str = "CONST_SPINDLE_SPEED(25.)",
    feed: str = "$",
    per_turn: str = "0.2",
    *,
    flags: str = ".F.,.F.,.F.",
    units: UnitProfile = ISO,
) -> Programmed:
    return read(
        f"#10=TURNING_TECHNOLOGY({feed},.TCP.,#11,{per_turn},{flags},$);",
        f"#11={speed};",
        units=units,
    )


class TestMilling:
    def test_feed_and_spindle_in_the_standards_units(self) -> None:
        conditions = milling()
        assert conditions.feed == Number(
            ref=Ref(10),
            attribute="feedrate",
            quantity=ProgrammedQuantity.FEED,
            value=40.0,
            scale=1000.0,
        )
        assert conditions.speed == Number(
            ref=Ref(10),
            attribute="spindle",
            quantity=ProgrammedQuantity.SPINDLE_SPEED,
            value=12.0,
            scale=-1.0,
        )

    def test_a_counter_clockwise_spindle_has_a_positive_scale(self) -> None:
        assert milling(spindle="12.").speed.scale == 1.0

    def test_cutting_speed_and_feed_per_tooth(self) -> None:
        conditions = milling("$", "2.5", "$", "0.1")
        assert conditions.feed.quantity is ProgrammedQuantity.FEED_PER_TOOTH
        assert (conditions.feed.value, conditions.feed.attribute) == (0.1, "feedrate_per_tooth")
        assert conditions.speed.quantity is ProgrammedQuantity.CUTTING_SPEED
        assert (conditions.speed.value, conditions.speed.attribute) == (2500.0, "cutspeed")

    def test_with_both_speeds_the_spindle_counts(self) -> None:
        conditions = milling(cutspeed="2.5")
        assert conditions.has_both_speeds
        assert conditions.speed.quantity is ProgrammedQuantity.SPINDLE_SPEED

    def test_one_speed_is_not_both(self) -> None:
        assert not milling().has_both_speeds

    def test_neither_speed_is_refused_by_rule_1(self) -> None:
        with pytest.raises(SchemaError, match=r"neither cutspeed nor spindle.*WR1") as caught:
            milling(spindle="$")
        assert caught.value.entity == "#10 MILLING_TECHNOLOGY"
        assert caught.value.line == FIRST_LINE

    def test_neither_feed_is_refused_by_rule_2(self) -> None:
        with pytest.raises(SchemaError, match=r"neither feedrate nor .*WR2") as caught:
            milling("$")
        assert caught.value.attribute == "feedrate"

    @every_case("number", HOSTILE)
    @every_case("attribute", ["feed", "cutspeed", "per_tooth"])
    def test_a_number_that_cuts_nothing_is_refused(self, attribute: str, number: str) -> None:
        other = {"cutspeed": "feed", "feed": "spindle", "per_tooth": "spindle"}[attribute]
        numbers = {other: "1.", attribute: number}
        names = ("feed", "cutspeed", "spindle", "per_tooth")
        with pytest.raises(SchemaError) as caught:
            milling(*(numbers.get(name, "$") for name in names))
        assert caught.value.line == FIRST_LINE

    @every_case("number", ["0.", "-0.", "1e400", "-1e400"])
    def test_a_spindle_that_does_not_turn_is_refused(self, number: str) -> None:
        with pytest.raises(SchemaError) as caught:
            milling(spindle=number)
        assert caught.value.attribute == "spindle"

    def test_a_whole_number_is_a_number(self) -> None:
        assert milling(spindle="-12").speed.value == 12.0

    def test_an_inhibited_override_is_said(self) -> None:
        assert milling(flags=".F.,.T.,.F.").inhibition == "inhibit_feedrate_override"
        assert not milling(flags=".F.,.F.,.T.").inhibition

    def test_a_feed_bound_to_the_spindle_is_said(self) -> None:
        assert milling(flags=".T.,.F.,.F.").is_synchronised
        assert not milling().is_synchronised


class TestUnits:
    @every_case(
        ("name", "quantity", "value"),
        [
            ("iso", ProgrammedQuantity.FEED, 120.0),
            ("rpm-mmin", ProgrammedQuantity.FEED, 0.002),
            ("rpm-mmtooth", ProgrammedQuantity.FEED_PER_TOOTH, 0.12),
            ("rpm-mmrev", ProgrammedQuantity.FEED_PER_REVOLUTION, 0.12),
            ("revs-mmtooth", ProgrammedQuantity.FEED_PER_TOOTH, 0.12),
            ("revs-mmrev", ProgrammedQuantity.FEED_PER_REVOLUTION, 0.12),
        ],
    )
    def test_what_a_feedrate_of_0_12_means(
        self, name: str, quantity: ProgrammedQuantity, value: float
    ) -> None:
        feed = milling("0.12", units=PROFILES[name]).feed
        assert feed.quantity is quantity
        assert feed.value == pytest.approx(value, rel=1e-15)

    @every_case("name", PROFILES)
    def test_a_spindle_of_minus_1200(self, name: str) -> None:
        speed = milling(spindle="-1200.", units=PROFILES[name]).speed
        assert speed.value == pytest.approx(1200.0 if "rpm" not in name else 20.0)
        assert speed.scale < 0.0

    @every_case("name", PROFILES)
    def test_a_cutting_speed_of_90(self, name: str) -> None:
        speed = milling(cutspeed="90.", spindle="$", units=PROFILES[name]).speed
        assert speed.value == pytest.approx(90_000.0 if name == "iso" else 1500.0)

    @every_case("name", PROFILES)
    def test_a_feed_per_tooth_is_in_mm_in_all(self, name: str) -> None:
        assert milling("$", per_tooth="0.1", units=PROFILES[name]).feed.value == 0.1

    @every_case("name", PROFILES)
    def test_the_adaptive_form_follows_the_profile(self, name: str) -> None:
        plain, other = milling(units=PROFILES[name]), adaptive(units=PROFILES[name])
        assert (plain.feed.value, plain.feed.quantity) == (
            other.feed.value,
            other.feed.quantity,
        )
        assert (plain.speed.value, plain.speed.scale) == (other.speed.value, other.speed.scale)

    @every_case("name", PROFILES)
    def test_a_lathes_feed_per_revolution_is_in_mm_in_all(self, name: str) -> None:
        assert turning(units=PROFILES[name]).feed.value == 0.2


class TestAdaptive:
    def test_feed_and_spindle_are_instances_of_their_own(self) -> None:
        conditions = adaptive()
        assert (conditions.speed.ref, conditions.speed.attribute) == (Ref(11), "value")
        assert (conditions.feed.ref, conditions.feed.attribute) == (Ref(12), "value")
        assert (conditions.feed.value, conditions.speed.value) == (40.0, 12.0)
        assert conditions.speed.scale == -1.0
        assert not conditions.inhibition

    def test_cutting_speed_and_feed_per_tooth(self) -> None:
        conditions = adaptive("CUTSPEED(.T.,2.5)", "FEEDRATE_PER_TOOTH(.T.,0.1)")
        assert conditions.feed.quantity is ProgrammedQuantity.FEED_PER_TOOTH
        assert conditions.speed.quantity is ProgrammedQuantity.CUTTING_SPEED
        assert (conditions.feed.value, conditions.speed.value) == (0.1, 2500.0)

    def test_a_feed_that_may_not_adapt_is_inhibited(self) -> None:
        assert adaptive(feed="FEEDRATE_TCP(.F.,0.04)").inhibition == "adaptive_allowed is false"

    def test_a_speed_that_may_not_adapt_leaves_the_feed_free(self) -> None:
        assert not adaptive("SPINDLE_SPEED(.F.,-12.)").inhibition

    def test_an_inhibited_override_is_said(self) -> None:
        assert adaptive(flags=".F.,.T.,.F.").inhibition == "inhibit_feedrate_override"

    def test_a_feed_bound_to_the_spindle_is_said(self) -> None:
        assert adaptive(flags=".T.,.F.,.F.").is_synchronised

    @every_case("number", ["$", *HOSTILE])
    def test_a_feed_that_cuts_nothing_is_refused(self, number: str) -> None:
        with pytest.raises(SchemaError):
            adaptive(feed=f"FEEDRATE_TCP(.T.,{number})")

    @every_case("number", ["$", "0.", "1e400"])
    def test_a_spindle_that_does_not_turn_is_refused(self, number: str) -> None:
        with pytest.raises(SchemaError):
            adaptive(f"SPINDLE_SPEED(.T.,{number})")

    def test_a_feed_that_is_not_there_is_refused(self) -> None:
        with pytest.raises(SchemaError, match="does not exist"):
            read("#10=MILLING_TECHNOLOGY(#11,#99,.F.,.F.,.F.);", "#11=CUTSPEED(.T.,1.);")


class TestTurning:
    def test_a_constant_spindle(self) -> None:
        conditions = turning("CONST_SPINDLE_SPEED(-25.)")
        assert conditions.speed == Number(
            ref=Ref(11),
            attribute="rot_speed",
            quantity=ProgrammedQuantity.SPINDLE_SPEED,
            value=25.0,
            scale=-1.0,
        )
        assert conditions.feed.quantity is ProgrammedQuantity.FEED_PER_REVOLUTION
        assert conditions.feed.value == 0.2
        assert conditions.max_spindle_speed is None

    def test_a_constant_cutting_speed_with_limit(self) -> None:
        conditions = turning("CONST_CUTTING_SPEED(3.,-50.)")
        assert (conditions.speed.attribute, conditions.speed.value) == ("speed", 3000.0)
        assert conditions.max_spindle_speed == 50.0
        assert conditions.spindle_speed(30.0) == pytest.approx(3000.0 / (30.0 * pi))
        assert conditions.spindle_speed(3.0) == 50.0

    def test_a_constant_cutting_speed_without_limit_follows_the_diameter(self) -> None:
        conditions = turning("CONST_CUTTING_SPEED(3.,$)")
        assert conditions.max_spindle_speed is None
        assert conditions.spindle_speed(1.0) == pytest.approx(3000.0 / pi)

    def test_the_limit_is_in_the_profiles_units(self) -> None:
        conditions = turning("CONST_CUTTING_SPEED(180.,3000.)", units=PROFILES["rpm-mmrev"])
        assert conditions.speed.value == pytest.approx(3000.0)
        assert conditions.max_spindle_speed == pytest.approx(50.0)

    def test_a_feedrate_counts_before_a_feed_per_revolution(self) -> None:
        assert turning(feed="0.004").feed.value == 4.0

    def test_no_feed_is_refused(self) -> None:
        with pytest.raises(SchemaError, match="neither feedrate nor feed_per_revolution"):
            turning(per_turn="$")

    def test_no_spindle_is_refused(self) -> None:
        with pytest.raises(SchemaError, match="has no spindle speed"):
            read("#10=TURNING_TECHNOLOGY($,.TCP.,$,0.2,.F.,.F.,.F.,$);")

    @every_case("number", HOSTILE)
    def test_a_feed_that_cuts_nothing_is_refused(self, number: str) -> None:
        with pytest.raises(SchemaError):
            turning(per_turn=number)

    @every_case(
        "speed",
        [
            "CONST_SPINDLE_SPEED(0.)",
            "CONST_SPINDLE_SPEED($)",
            "CONST_SPINDLE_SPEED(1e400)",
            "CONST_CUTTING_SPEED(-3.,50.)",
            "CONST_CUTTING_SPEED(0.,50.)",
        ],
    )
    def test_a_speed_that_cuts_nothing_is_refused(self, speed: str) -> None:
        with pytest.raises(SchemaError) as caught:
            turning(speed)
        assert caught.value.line == FIRST_LINE + 1

    def test_a_thread_binds_the_feed_to_the_spindle(self) -> None:
        assert turning(flags=".T.,.F.,.F.").is_synchronised

    def test_an_inhibited_override_is_said(self) -> None:
        assert turning(flags=".F.,.T.,.F.").inhibition == "inhibit_feedrate_override"


class TestInverse:
    """Writing what was read gives the number of the file."""

    FORMS = (
        milling("0.04", "$", "-12.", "$"),
        milling("$", "2.5", "$", "0.12"),
        milling("0.0123", "2.5", "$", "$"),
        adaptive(),
        adaptive("CUTSPEED(.T.,2.5)", "FEEDRATE_PER_TOOTH(.T.,0.12)"),
        turning(),
        turning("CONST_CUTTING_SPEED(3.,$)", "0.004", "$"),
        turning("CONST_SPINDLE_SPEED(-25.)"),
        *(milling("0.0123", units=units) for units in PROFILES.values()),
        *(milling("0.0123", "80.", "$", units=units) for units in PROFILES.values()),
    )

    @every_case("conditions", FORMS)
    @every_case(("diameter", "teeth"), [(18.0, 4), (6.3, 1), (63.0, 5)])
    def test_feed_number_is_the_inverse_of_reading(
        self, conditions: Programmed, diameter: float, teeth: int
    ) -> None:
        speed = conditions.spindle_speed(diameter)
        feed = conditions.feed_per_tooth(speed, teeth)
        number = conditions.feed_number(feed, speed=speed, teeth=teeth)
        assert number == pytest.approx(conditions.feed.value / conditions.feed.scale, rel=1e-14)

    @every_case("conditions", FORMS)
    @every_case("diameter", [18.0, 6.3, 63.0])
    def test_speed_number_is_the_inverse_of_reading(
        self, conditions: Programmed, diameter: float
    ) -> None:
        number = conditions.speed_number(conditions.spindle_speed(diameter), diameter)
        written = conditions.speed.value / conditions.speed.scale
        assert number == pytest.approx(written, rel=1e-14)

    def test_a_clockwise_spindle_is_written_with_its_sign(self) -> None:
        assert milling().speed_number(20.0, 18.0) == -20.0
        assert turning("CONST_SPINDLE_SPEED(-25.)").speed_number(30.0, 40.0) == -30.0

    def test_feed_per_tooth_is_feed_over_speed_and_teeth(self) -> None:
        assert milling().feed_per_tooth(12.0, 4) == pytest.approx(40.0 / 48.0)

    def test_a_feed_per_revolution_is_shared_by_the_teeth(self) -> None:
        conditions = milling("0.4", units=PROFILES["rpm-mmrev"])
        assert conditions.feed_per_tooth(12.0, 4) == pytest.approx(0.1)

    def test_a_spindle_does_not_depend_on_the_diameter(self) -> None:
        assert milling().spindle_speed(1.0) == milling().spindle_speed(100.0) == 12.0


def test_another_instance_is_no_technology() -> None:
    with pytest.raises(SchemaError, match="is not a milling or turning technology") as caught:
        read("#10=ADAPTIVE_CONTROL();")
    assert caught.value.entity == "#10 ADAPTIVE_CONTROL"
