"""A machine written and read again."""

import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.files import handling_file as between
from simulator.files import holding_file as read_as
from simulator.files import machine_file as allowed
from simulator.files import mode_file as modes
from simulator.files.machine_file import MachineFile, machine_toml
from simulator.files.material_file import MaterialHead
from simulator.files.toml_file import converted, read_toml_head
from simulator.library import load_machine, machine_names
from simulator.planner_settings import PlannerSettings
from simulator.spec import (
    Axis,
    AxisDrive,
    Handling,
    HandlingState,
    Machine,
    MachineKind,
    ModeDirection,
    PowerDeviation,
    Spindle,
    SpindlePoint,
    VibratingPart,
    VibrationMode,
)
from simulator.work_holding import Chuck, Clamp, Holding
from stepnc_model.units import (
    n_mm_from_n_um,
    newtons_from_kn,
    nmm_from_nm,
    rev_s_from_rpm,
    speed_from_mm_min,
    watts_from_kw,
)

XML = Path(__file__).parent / "data" / "paper003.xml"


def read(text: str, name: str = "my") -> Machine:
    return converted(tomllib.loads(text), MachineFile, Path("my.toml")).machine(name)


def within(kind: Any) -> st.SearchStrategy[float]:
    """Numbers that a key of a file may have."""
    (span,) = get_args(kind)[1:]
    return st.floats(span.ge, span.le)


def maybe(values: st.SearchStrategy[float]) -> st.SearchStrategy[float | None]:
    return st.none() | values


FEEDS = within(allowed.Feed).map(speed_from_mm_min)
WATTS = within(allowed.AuxiliaryPower)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=20)
DRIVES = st.builds(
    AxisDrive,
    lead=within(allowed.Lead),
    table_mass=within(allowed.MovedMass),
    workpiece_mass=within(allowed.Mass),
    screw_mass=within(allowed.Mass),
    screw_diameter=within(allowed.ScrewDiameter),
    coupling_inertia=within(allowed.DriveInertia),
    motor_inertia=within(allowed.DriveInertia),
    guide_friction=within(allowed.Friction),
    bearing_friction=within(allowed.Friction),
    preload=within(allowed.Preload),
    viscous=within(allowed.Viscous).map(nmm_from_nm),
    gear_ratio=within(allowed.GearRatio),
    efficiency=within(allowed.Efficiency),
    regeneration=within(allowed.Regeneration),
)
AXES = st.builds(
    Axis,
    name=st.sampled_from("XYZ"),
    travel=st.sampled_from([(-float("inf"), 10.5), (-0.1, float("inf")), (0.0, 1 / 3)]),
    rapid=FEEDS,
    max_feed=FEEDS,
    acceleration=within(allowed.Acceleration),
    jerk=maybe(within(allowed.Jerk)),
    drive=st.none() | DRIVES,
)


NAMES = TEXTS.map(str.strip).filter(bool)
TOOL_MODES = st.fixed_dictionaries({
    "part": st.just(VibratingPart.TOOL),
    "tool": NAMES,
    "tool_diameter": maybe(within(modes.ModeDiameter)),
})
WORK_MODES = st.just({"part": VibratingPart.WORKPIECE})
MODES = st.builds(
    lambda of, **numbers: VibrationMode(**of, **numbers),
    TOOL_MODES | WORK_MODES,
    direction=st.sampled_from(ModeDirection),
    natural_frequency=within(modes.Frequency),
    damping_ratio=within(modes.Damping),
    stiffness=within(modes.Stiffness).map(n_mm_from_n_um),
    source=TEXTS,
)


@st.composite
def spindles(draw: st.DrawFn) -> Spindle:
    """A curve of up to three points, far enough apart to be no step."""
    slowest = draw(st.floats(1.0, 1000.0))
    points = [
        SpindlePoint(
            speed=rev_s_from_rpm(slowest * 3.0**row),
            power=watts_from_kw(draw(st.floats(0.1, 100.0))),
            torque=draw(maybe(st.floats(0.1, 1000.0).map(nmm_from_nm))),
        )
        for row in range(draw(st.integers(1, 3)))
    ]
    return Spindle(
        curve=tuple(points),
        efficiency=draw(within(allowed.Efficiency)),
        min_speed=draw(maybe(st.floats(0.1, 10.0).map(rev_s_from_rpm))),
        max_speed=draw(maybe(st.floats(11.0, 500_000.0).map(rev_s_from_rpm))),
        acceleration=draw(maybe(within(allowed.SpindleAcceleration))),
        inertia=draw(maybe(within(allowed.Inertia))),
        idle_power=draw(WATTS),
        idle_power_per_speed=draw(within(allowed.IdlePowerPerSpeed)),
        idle_power_per_speed_squared=draw(within(allowed.IdlePowerPerSpeedSquared)),
        regeneration=draw(within(allowed.Regeneration)),
    )


STATES = st.builds(
    HandlingState, time=within(between.StateTime), power=within(between.StatePower)
)
HANDLINGS = st.builds(
    Handling,
    batch_setup=STATES,
    part_setup=STATES,
    part_ejection=STATES,
    batch_ejection=STATES,
    time_scatter=within(between.HalfWidth),
    source=TEXTS,
)
DEVIATIONS = st.builds(
    PowerDeviation,
    feed=within(between.HalfWidth),
    traverse=within(between.HalfWidth),
    source=TEXTS,
)


MACHINES = st.builds(
    Machine,
    name=st.just("my"),
    title=TEXTS,
    kind=st.sampled_from(MachineKind),
    spindle=spindles(),
    axes=st.lists(AXES, max_size=3).map(tuple),
    rapid=maybe(FEEDS),
    max_feed=maybe(FEEDS),
    max_cutting_force=maybe(within(allowed.CuttingForce)),
    max_axial_depth=maybe(within(allowed.AxialDepth)),
    block_time=maybe(within(allowed.BlockTime)),
    base_power=WATTS,
    coolant_power=WATTS,
    tool_change=within(allowed.ToolChange),
    source=TEXTS,
    remarks=st.lists(TEXTS, max_size=3).map(tuple),
    modes=st.lists(MODES, max_size=3).map(tuple),
    block_time_source=st.just("") | TEXTS,
    handling=st.none() | HANDLINGS,
    deviation=st.none() | DEVIATIONS,
)


def held(machine: Machine, holding: Holding | None) -> Machine:
    """The machine with what can hold on one of its kind."""
    is_fitting = isinstance(holding, Chuck) is (machine.kind is MachineKind.LATHE)
    return replace(machine, holdings=(holding,) if holding and is_fitting else ())


KILONEWTONS = within(read_as.Force).map(newtons_from_kn)
CHUCKS = st.builds(
    lambda jaw, loss, **rest: Chuck(**jaw, **loss, **rest),
    st.just({})
    | st.fixed_dictionaries({
        "jaw_mass": within(read_as.JawMass),
        "jaw_radius": within(read_as.Grip),
    }),
    st.just({})
    | st.fixed_dictionaries({
        "lost_force": KILONEWTONS,
        "lost_at": within(read_as.LossSpeed).map(rev_s_from_rpm),
    }),
    clamping_force=KILONEWTONS,
    friction=within(read_as.FrictionCoefficient),
    source=TEXTS,
    setup=TEXTS.map(str.strip),
    jaws=st.integers(2, 12),
    grip_diameter=maybe(within(read_as.Grip)),
    grip_length=maybe(within(read_as.Grip)),
    jaw_face=maybe(within(read_as.Position)),
    safety_factor=within(read_as.SafetyFactor),
    clamping_safety_factor=within(read_as.SafetyFactor),
    has_tailstock=st.sampled_from([None, False, True]),
)
CLAMPS = st.builds(
    Clamp,
    holding_force=KILONEWTONS,
    friction=within(read_as.FrictionCoefficient),
    source=TEXTS,
    setup=TEXTS.map(str.strip),
    safety_factor=within(read_as.SafetyFactor),
)


@settings(max_examples=60)
@given(
    machine=MACHINES,
    holding=st.none() | CHUCKS | CLAMPS,
    notes=st.lists(TEXTS, max_size=3),
)
def test_a_machine_reads_back_equal(
    machine: Machine, holding: Holding | None, notes: list[str]
) -> None:
    machine = held(machine, holding)
    assert read(machine_toml(machine, notes=notes)) == machine


@pytest.mark.parametrize("name", machine_names())
def test_every_machine_of_the_library_reads_back_equal(name: str) -> None:
    machine = load_machine(name)
    assert read(machine_toml(machine), name) == machine


def test_a_machine_from_xml_reads_back_equal() -> None:
    machine = load_machine(str(XML))
    assert read(machine_toml(machine), "paper003") == machine


def test_numbers_are_as_short_as_they_were_typed() -> None:
    text = machine_toml(load_machine("vmc15"))
    for line in (
        "rapid_mm_min = 36000",
        "speed_rpm = 1500",
        "torque_nm = 81.2",
        "viscous_nm_s_per_rad = 0.003",
        "inertia_kg_m2 = 0.02",
    ):
        assert f"\n{line}\n" in text


def test_a_value_that_no_rpm_gives_is_at_most_a_bit_off() -> None:
    machine = load_machine("vmc15")
    for speed in (100.0 / 3.0, 199.99999999999997, 30.000000000000004):
        fitted = replace(machine, spindle=replace(machine.spindle, max_speed=speed))
        found = read(machine_toml(fitted)).spindle.max_speed
        assert found == pytest.approx(speed, rel=3e-16)


def test_notes_are_comments_whatever_they_hold() -> None:
    notes = ("fitted to four runs\nbase power 371 to 384 W (95 %)", "bell\x07 and [table]")
    text = machine_toml(load_machine("paper002"), notes=notes)
    assert text.splitlines()[:3] == [
        "# fitted to four runs",
        "# base power 371 to 384 W (95 %)",
        "# bell  and [table]",
    ]


def test_the_head_of_the_file_is_read_without_the_rest(tmp_path: Path) -> None:
    path = tmp_path / "my.toml"
    path.write_text(machine_toml(load_machine("vmc15")), encoding="utf-8")
    assert read_toml_head(path, MaterialHead).title == "Vertical machining centre, 15 kW"
    assert load_machine(str(path)).spindle == load_machine("vmc15").spindle


def test_the_planner_of_a_linuxcnc_is_written_where_it_is_not_the_usual(tmp_path: Path) -> None:
    mill = load_machine("vmc15")
    assert "[linuxcnc]" not in machine_toml(mill)
    quick = replace(mill, planner=PlannerSettings(max_feed_override=1.5, servo_period=0.0005))
    path = tmp_path / "vmc15.toml"
    path.write_text(machine_toml(quick))
    assert load_machine(str(path)) == quick
