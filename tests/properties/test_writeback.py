"""Whatever is advised: records survive, bytes are stable, nobody else's numbers change."""

from pathlib import Path
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from stepnc_model.editing import writeback
from stepnc_model.editing.cut_settings import rounded
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.editing.record import MODES, AdviceRecord
from stepnc_model.editing.writeback import WorkingstepUpdate
from stepnc_model.entities.optimisation import FaceMillingImmersion
from stepnc_model.part21.reader import Part21File
from stepnc_model.programs.program import Program
from stepnc_model.programs.technology import programmed

PARTS = Path(__file__).parents[2] / "examples" / "parts"
SAMPLES = {path.stem: path.read_bytes() for path in sorted(PARTS.glob("*.stpnc"))}

NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
POSITIVE = st.floats(1e-9, 1e9)
TEXTS = st.text(st.characters(exclude_categories=["Cs"]), max_size=8)
PROFILES = st.sampled_from(FileProfile)
NAMES = st.sampled_from(sorted(SAMPLES))


@st.composite
def records(draw: st.DrawFn) -> AdviceRecord:
    """Any record; the angle of contact and the name of the immersion come together."""
    faces = st.tuples(NUMBERS, st.sampled_from(FaceMillingImmersion).map(str))
    angle, immersion = draw(faces | st.just((None, None)))
    number = st.none() | NUMBERS
    return AdviceRecord(
        mode=draw(st.sampled_from(sorted(MODES))),
        id=draw(TEXTS),
        description=draw(TEXTS),
        machine=draw(TEXTS),
        material=draw(TEXTS),
        generator=draw(TEXTS),
        active_limit=draw(TEXTS),
        number_of_passes=draw(st.integers(1, 1000)),
        feed_per_tooth=draw(NUMBERS),
        axial_depth=draw(NUMBERS),
        machine_power=draw(NUMBERS),
        cutting_power=draw(NUMBERS),
        spindle_speed=draw(NUMBERS),
        specific_cutting_resistance=draw(NUMBERS),
        machining_time=draw(NUMBERS),
        motor_power=draw(NUMBERS),
        cutting_force=draw(NUMBERS),
        energy=draw(NUMBERS),
        surface_roughness=draw(number),
        contact_angle=angle,
        immersion=immersion,
        programmed_feedrate=draw(number),
        programmed_cutspeed=draw(number),
        programmed_axial_depth=draw(number),
    )


def program_of(data: bytes) -> Program:
    return Program(Part21File.from_bytes(data))


def converted(data: bytes, profile: FileProfile) -> bytes:
    return writeback.convert(program_of(data), profile)


def changes(draw: Any, program: Program) -> list[WorkingstepUpdate]:
    """Advice for some of the workingsteps, in the order of the program."""
    steps = range(len(program.workingsteps))
    chosen = draw(st.lists(st.sampled_from(steps), unique=True, min_size=1, max_size=4))
    advice = []
    for place in sorted(chosen):
        step = program.workingsteps[place]
        conditions = programmed(program, step.technology_ref)
        advice.append(
            WorkingstepUpdate(
                workingstep=step,
                programmed=conditions,
                record=draw(records()),
                feed=draw(POSITIVE),
                speed=draw(st.none() | POSITIVE),
                depth=draw(st.none() | POSITIVE),
            )
        )
    return advice


def again(program: Program, advice: list[WorkingstepUpdate]) -> list[WorkingstepUpdate]:
    """The same advice for the program as it was written."""
    steps = {step.ref: step for step in program.workingsteps}
    return [
        WorkingstepUpdate(
            workingstep=steps[each.workingstep.ref],
            programmed=programmed(program, steps[each.workingstep.ref].technology_ref),
            record=each.record,
            feed=each.feed,
            speed=each.speed,
            depth=each.depth,
        )
        for each in advice
    ]


@settings(max_examples=40, deadline=None)
@given(st.data(), NAMES, PROFILES)
def test_every_record_is_read_as_it_was_written(
    data: st.DataObject, name: str, profile: FileProfile
) -> None:
    program = program_of(SAMPLES[name])
    advice = changes(data.draw, program)
    after = program_of(writeback.write(program, advice, profile))
    assert writeback.records(after) == {
        int(each.workingstep.operation_ref): each.record for each in advice
    }


@settings(max_examples=40, deadline=None)
@given(st.data(), NAMES, PROFILES)
def test_the_numbers_advised_are_programmed_and_all_others_stay(
    data: st.DataObject, name: str, profile: FileProfile
) -> None:
    program = program_of(SAMPLES[name])
    advice = {each.workingstep.ref: each for each in changes(data.draw, program)}
    after = program_of(writeback.write(program, list(advice.values()), profile))
    for old, new in zip(program.workingsteps, after.workingsteps, strict=True):
        was = programmed(program, old.technology_ref)
        now = programmed(after, new.technology_ref)
        change = advice.get(old.ref)
        if change is None:
            assert (now.feed.value, now.speed.value) == (was.feed.value, was.speed.value)
            continue
        feed = now.feed.in_file(now.feed.value)
        assert rounded(feed) == rounded(change.feed)
        if change.speed is None:
            assert now.speed.value == was.speed.value
        else:
            speed = abs(now.speed.in_file(now.speed.value))
            assert rounded(speed) == rounded(change.speed)


@settings(max_examples=40, deadline=None)
@given(st.data(), NAMES, PROFILES)
def test_the_same_advice_twice_gives_the_same_bytes(
    data: st.DataObject, name: str, profile: FileProfile
) -> None:
    program = program_of(SAMPLES[name])
    advice = changes(data.draw, program)
    once = writeback.write(program, advice, profile)
    written = program_of(once)
    assert writeback.write(written, again(written, advice), profile) == once


@settings(max_examples=40, deadline=None)
@given(st.data(), NAMES, PROFILES)
def test_conversion_keeps_records_and_is_stable(
    data: st.DataObject, name: str, profile: FileProfile
) -> None:
    program = program_of(SAMPLES[name])
    once = writeback.write(program, changes(data.draw, program), profile)
    wanted = writeback.records(program_of(once))
    assert converted(once, profile) == once
    for other in FileProfile:
        assert writeback.records(program_of(converted(once, other))) == wanted


@settings(max_examples=30, deadline=None)
@given(st.data(), NAMES, PROFILES)
def test_a_file_is_the_same_after_it_was_in_another_profile(
    data: st.DataObject, name: str, profile: FileProfile
) -> None:
    program = program_of(SAMPLES[name])
    once = writeback.write(program, changes(data.draw, program), profile)
    for other in FileProfile:
        assert converted(converted(once, other), profile) == once


@settings(max_examples=30, deadline=None)
@given(st.data(), NAMES, PROFILES)
def test_no_instance_and_no_comment_of_the_file_is_lost(
    data: st.DataObject, name: str, profile: FileProfile
) -> None:
    program = program_of(SAMPLES[name])
    once = writeback.write(program, changes(data.draw, program), profile)
    before, after = program.file, Part21File.from_bytes(once)
    assert list(after.ids())[: len(before)] == list(before.ids())
    assert all(after.keyword(id) == before.keyword(id) for id in before.ids())
    assert once.count(b"/*") >= SAMPLES[name].count(b"/*")
