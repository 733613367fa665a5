"""The ring of observations against a list that forgets nothing."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from extras.agent.model.buffer import EVERY, ConditionValue, ObservationBuffer, Value
from tests.extras.agent.model.test_model import TYPES, model_from

MODEL = model_from(TYPES)
COUNT = len(MODEL.items)
CONDITION, SET = MODEL.index["cond"], MODEL.index["set"]


def value_of(item: int, number: int) -> Value:
    if item == CONDITION:
        levels = ("NORMAL", "WARNING", "FAULT")
        code = ("", "a", "b")[number % 3]
        return ConditionValue(level=levels[number // 3 % 3], native_code=code)
    if item == SET:
        return {"ab"[number % 2]: None if number % 5 == 0 else str(number)}
    return float(number)


def shown(values: list[tuple[int, int]], at: int) -> list[object]:
    """What holds after a sequence number, from all that came before."""
    state: list[object] = [None] * COUNT
    state[CONDITION], state[SET] = {"": "UNAVAILABLE"}, None
    for item, number in values[: at - COUNT]:
        value = value_of(item, number)
        if isinstance(value, ConditionValue):
            active = state[CONDITION]
            assert isinstance(active, dict)
            active = {
                key: level
                for key, level in active.items()
                if level in {"WARNING", "FAULT"} and key != value.native_code
            }
            if value.level == "NORMAL":
                active = {} if not value.native_code else active
            else:
                active[value.native_code] = value.level
            state[CONDITION] = active or {"": "NORMAL"}
        elif isinstance(value, dict):
            before = state[SET] if isinstance(state[SET], dict) else {}
            merged = {**before, **value}  # type: ignore[dict-item]
            state[SET] = {key: each for key, each in merged.items() if each is not None}
        else:
            state[item] = value
    return state


def held(buffer: ObservationBuffer, at: int) -> list[object]:
    found: list[object] = []
    for item, entries in enumerate(buffer.state_at(at)):
        values = [each.value for each in entries]
        if item == CONDITION:
            reports = [each for each in values if isinstance(each, ConditionValue)]
            found.append({each.native_code: each.level for each in reports})
        else:
            found.append(values[0])
    return found


@settings(max_examples=30)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(1, 4 * EVERY),
    size=st.sampled_from([1000, 1500, 2500]),
)
def test_what_held_at_any_time_is_known_while_it_is_kept(
    seed: int, count: int, size: int
) -> None:
    random = np.random.default_rng(seed)
    items = random.integers(0, COUNT, count)
    numbers = random.integers(0, 30, count)
    values = list(zip(items.tolist(), numbers.tolist(), strict=True))
    buffer = ObservationBuffer(model=MODEL, size=size, now=0)
    begin = 0
    while begin < count:
        end = min(count, begin + int(random.integers(1, 700)))
        told = [value_of(item, number) for item, number in values[begin:end]]
        buffer.append(items[begin:end], np.arange(begin, end), told)
        begin = end
    assert buffer.last == COUNT + count
    assert buffer.first == max(1, buffer.next - size)
    for at in {
        buffer.first,
        buffer.last,
        *random.integers(buffer.first, buffer.next, 3).tolist(),
    }:
        if at >= COUNT:
            assert held(buffer, at) == shown(values, at)
    assert held(buffer, buffer.last) == shown(values, buffer.last)


def test_times_are_kept_as_they_are() -> None:
    buffer = ObservationBuffer(model=MODEL, size=1000, now=50)
    buffer.append(np.zeros(4, dtype=int), np.array([60, 40, 70, 65]), [1.0, 2.0, 3.0, 4.0])
    _, times = buffer.take(np.arange(COUNT + 1, COUNT + 5))
    assert times.tolist() == [60, 40, 70, 65]
    assert buffer.last_time == 70
