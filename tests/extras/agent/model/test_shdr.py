"""Lines of SHDR, read and written."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from extras.agent.model.buffer import ConditionValue, TimeSeriesValue, Value
from extras.agent.model.shdr import ShdrObservation, read_line, read_time, written
from tests.every_case import every_case
from tests.extras.agent.model.test_model import TYPES, model_from

MODEL = model_from(TYPES)
T0 = "2026-01-02T03:04:05.678901Z"
MICRO = 1_767_323_045_678_901
NOW = 7


def read(line: str) -> list[tuple[str, Value]]:
    found = read_line(line, MODEL, lambda: NOW)
    return [(MODEL.items[each.item].id, each.value) for each in found]


@every_case(
    ("line", "expected"),
    [
        (f"{T0}|avail|AVAILABLE", [("avail", "AVAILABLE")]),
        (f"{T0}|avail|ON|D:avail|UNAVAILABLE", [("avail", "ON"), ("avail", None)]),
        (f"{T0}|nothing|5|avail|AVAILABLE", [("avail", "AVAILABLE")]),
        (f"{T0}|feed|60", [("feed", pytest.approx(25.4))]),
        (f"{T0}|feed|fast|temp|212", [("temp", pytest.approx(100.0))]),
        (f"{T0}|feed|nan", []),
        (f"{T0}|cond|FAULT|7|2|HIGH|too hot", [
            ("cond", ConditionValue(level="FAULT", native_code="7", native_severity="2",
                                    qualifier="HIGH", text="too hot"))]),
        (f"{T0}|cond|normal||||", [("cond", ConditionValue(level="NORMAL"))]),
        (f"{T0}|cond|odd||||", []),
        (f"{T0}|s|3|100|1 2 3", [("series", TimeSeriesValue(values=(1, 2, 3), rate=100.0))]),
        (f"{T0}|s|4|100|1 2 3", []),
        (f"{T0}|s|UNAVAILABLE||", [("series", None)]),
        (f"{T0}|set|a=1 b={{x y}} c='p q' d", [
            ("set", {"a": "1", "b": "x y", "c": "p q", "d": None})]),
        (f"{T0}|msg|17|Door is open", [("msg", "Door is open")]),
        ("* PONG 10000", []),
        ("avail|AVAILABLE", []),
        ("", []),
    ],
)  # fmt: skip
def test_a_line_is_read(line: str, expected: list[tuple[str, Value]]) -> None:
    assert read(line) == expected


@every_case(
    ("text", "time"),
    [
        (T0, MICRO),
        ("2026-01-02T03:04:05.678901", MICRO),
        ("2026-01-02T04:04:05.678901+01:00", MICRO),
        ("2026-01-02T03:04:05.678901Z@1.5", MICRO),
        ("2026-01-02T03:04:05Z", MICRO - 678_901),
        ("", NOW),
        ("yesterday", NOW),
    ],
)
def test_times_are_utc_unless_they_say_so(text: str, time: int) -> None:
    assert read_time(text, lambda: NOW) == time


WORDS = st.text(
    st.characters(exclude_categories=["Cs", "Cc", "Z"], exclude_characters="|"), min_size=1
)
NUMBERS = st.floats(-1e6, 1e6).map(lambda value: float(f"{value:.6g}"))
LEVELS = st.sampled_from(["NORMAL", "WARNING", "FAULT"])


@given(
    st.one_of(
        st.tuples(st.just("msg"), st.just(None)),
        st.tuples(st.just("avail"), WORDS.filter(lambda text: text != "UNAVAILABLE")),
        st.tuples(
            st.just("series"),
            st.builds(TimeSeriesValue, values=st.lists(NUMBERS, min_size=1).map(tuple),
                      rate=st.sampled_from([0.0, 10.0])),
        ),
        st.tuples(st.just("cond"), st.builds(ConditionValue, level=LEVELS, native_code=WORDS,
                                             text=WORDS)),
    )
)  # fmt: skip
def test_what_is_written_is_read_again(told: tuple[str, Value]) -> None:
    id, value = told
    (line,) = written(MODEL, MODEL.index[id], MICRO, value)
    if id == "msg":
        return
    assert read_line(line, MODEL, lambda: NOW) == [
        ShdrObservation(MODEL.index[id], MICRO, value)
    ]
