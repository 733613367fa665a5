"""What ``--disturb`` understands, and that it refuses the rest in one sentence."""

from math import isfinite

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controller.orders import Criterion, CriterionTo, MotorPowerTo, SwitchTo
from service.control.disturbances import Disturbances, disturbances, time_of
from simulator.plant.hidden_behaviour import HiddenChange, HiddenQuantity
from stepnc_model.errors import StepNcError
from tests.every_case import every_case

NAMES = (
    "depth", "hardness", "material", "tooth", "silence", "kc", "wear", "runout", "lag", "noise",
    "drift", "missing", "power", "mode", "control", "luck",
)  # fmt: skip
UNITS = ("", "%", "s", "ms", "min", "mm/min", "um", "µm", "N/s", "N")


def read(*words: str) -> Disturbances:
    return disturbances(words, hardness=lambda name: {"c45": 1.25}[name])


@every_case(
    ("word", "change"),
    [
        ("depth:+50%@12s", HiddenChange(time=12.0, what=HiddenQuantity.DEPTH, value=1.5)),
        ("depth:-50%@12", HiddenChange(time=12.0, what=HiddenQuantity.DEPTH, value=0.5)),
        (
            "hardness:1.3@2min",
            HiddenChange(time=120.0, what=HiddenQuantity.HARDNESS, value=1.3),
        ),
        ("material:c45@0s", HiddenChange(time=0.0, what=HiddenQuantity.HARDNESS, value=1.25)),
        ("tooth:1@1e1s", HiddenChange(time=10.0, what=HiddenQuantity.TOOTH, value=0.0)),
        ("silence:500ms@1s", HiddenChange(time=1.0, what=HiddenQuantity.SILENCE, value=0.5)),
        (" depth:+50 %@12 s", HiddenChange(time=12.0, what=HiddenQuantity.DEPTH, value=1.5)),
    ],
)
def test_changes_come_at_their_time(word: str, change: HiddenChange) -> None:
    assert read(word).hidden.changes == (change,)
    assert time_of(word) == change.time


def test_what_holds_from_the_start_has_no_time() -> None:
    found = read("kc:+30%", "wear:0.06mm/min", "runout:20µm", "lag:0.1s", "noise:5%",
                 "drift:-1N/s", "missing:10%")  # fmt: skip
    hidden, dynamometer = found.hidden, found.bench.dynamometer
    assert hidden.force_factor == pytest.approx(1.3)
    assert hidden.wear_rate == pytest.approx(0.001)
    assert hidden.eccentricity == pytest.approx(0.02)
    assert hidden.servo_lag == pytest.approx(0.1)
    assert dynamometer.noise == pytest.approx(0.05)
    assert dynamometer.drift == -1.0
    assert dynamometer.missing == pytest.approx(0.1)
    assert time_of("kc:1.3") is None


def test_orders_come_in_the_order_of_their_times() -> None:
    found = read("mode:qc@9s", "power:-50%@3s", "control:off@1s", "control:on@2s")
    assert [each.time for each in found.orders] == [1.0, 2.0, 3.0, 9.0]
    assert [each.order for each in found.orders] == [
        SwitchTo(is_on=False),
        SwitchTo(is_on=True),
        MotorPowerTo(factor=0.5),
        CriterionTo(criterion=Criterion.QC),
    ]


@every_case(
    ("word", "message"),
    [
        ("", "write it like"),
        ("depth", "write it like"),
        ("luck:1@2s", "unknown kind"),
        ("depth:+50%", "add a time"),
        ("depth:+50%@", "'' is not a number"),
        ("depth:+50%@-1s", "at least 0 s"),
        ("depth:+50%@nan", "'nan' is not a number"),
        ("depth:+50%@1e999s", "'1e999s' is not a number"),
        ("depth:-100%@1s", "at most +900 %"),
        ("depth:nan@1s", "'nan' is not a number"),
        ("depth:1.2.3@1s", "'1.2.3' is not a number"),
        ("tooth:0@1s", "1 to 100"),
        ("tooth:1.5@1s", "tooth numbers"),
        ("silence:0s@1s", "0.001 to 10000 s"),
        ("kc:1.3@5s", "from the start"),
        ("runout:1mm", "um or µm"),
        ("noise:100%", "0 to 99 %"),
        ("missing:5", "'5' is not a number"),
        ("mode:EC@1s", "TC or QC"),
        ("control:maybe@1s", "'on' or 'off'"),
        ("power:-100%@1s", "above -100 %"),
    ],
)
def test_what_is_no_disturbance_is_refused(word: str, message: str) -> None:
    with pytest.raises(StepNcError) as caught:
        read(word)
    assert message in str(caught.value)
    assert word in str(caught.value)


def test_a_refusal_repeats_the_disturbance_and_names_its_bounds() -> None:
    with pytest.raises(StepNcError) as caught:
        read("depth:-100%@1s")
    assert str(caught.value) == (
        "disturbance 'depth:-100%@1s': it must be above -100 % and at most +900 %"
    )


numbers = st.one_of(
    st.floats(width=32).map(str),
    st.integers(-200, 200).map(lambda value: f"{value:+d}"),
    st.text(alphabet="0123456789.+-eE", max_size=6),
)
words = st.one_of(
    st.builds(
        lambda name, number, unit, time: f"{name}:{number}{unit}{time}",
        st.sampled_from(NAMES),
        numbers,
        st.sampled_from(UNITS),
        st.one_of(
            st.just(""), st.builds(lambda n, u: f"@{n}{u}", numbers, st.sampled_from(UNITS))
        ),
    ),
    st.text(max_size=20),
    st.text(alphabet=":@%+s.1depthkcmo", max_size=14),
)


@given(word=words)
def test_any_word_is_understood_with_sane_numbers_or_refused(word: str) -> None:
    try:
        found = disturbances([word], hardness=lambda _: 1.0)
    except StepNcError:
        return
    hidden, dynamometer = found.hidden, found.bench.dynamometer
    for change in hidden.changes:
        assert isfinite(change.time)
        assert change.time >= 0.0
        assert isfinite(change.value)
        if change.what in {HiddenQuantity.DEPTH, HiddenQuantity.HARDNESS}:
            assert 0.0 < change.value <= 100.0
    assert 0.0 < hidden.force_factor <= 100.0
    assert 0.0 <= hidden.wear_rate <= 1.0 / 60.0
    assert 0.0 < hidden.servo_lag <= 10.0
    assert 0.0 <= dynamometer.missing < 1.0
    assert all(isfinite(order.time) and order.time >= 0.0 for order in found.orders)
    assert len(hidden.changes) + len(found.orders) <= 1
