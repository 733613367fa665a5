"""What holds for every value, every file and every damaged copy of a file."""

import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from stepnc_model.errors import Part21Error
from stepnc_model.part21.index import parse_record
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.tokens import decode, encode, is_tidy, tidy_values
from stepnc_model.part21.values import DERIVED, Binary, Enumeration, Real, Ref, Typed, Value
from stepnc_model.part21.writer import Edits, format_value

CORPUS = Path(__file__).parents[3] / "shared" / "corpus"
HEAD = (
    b"ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
    b"FILE_NAME('n','',(''),(''),'','','');\nFILE_SCHEMA(('S'));\nENDSEC;\nDATA;\n"
)
TAIL = b"ENDSEC;\nEND-ISO-10303-21;\n"
SAMPLE = (
    HEAD
    + b"#1=DIRECTION('z; it''s',(0.,-1.5E-3,1.));\r\n/* #1=OLD(); */\n#20=(A(1)B(.T.,$));\n"
    b"#3= PLANE_FINISH_MILLING (*, 'HOLE #4=', /* c */ (#1, #20),\n\tL_M(0.5), \"1F\" ) ;\n"
    b"#40=!NOTE('\\X2\\00E9\\X0\\ \\S\\D');#5=NONE();\n\n" + TAIL
)

names = st.from_regex(r"[A-Z][A-Z0-9_]{0,12}", fullmatch=True)
texts = st.text(st.characters(exclude_categories=()), max_size=12)
scalars: st.SearchStrategy[Value] = st.one_of(
    st.none(),
    st.just(DERIVED),
    st.integers(),
    st.integers(min_value=1, max_value=10**17).map(Ref),
    st.floats(allow_nan=False, allow_infinity=False).map(Real),
    texts,
    names.map(Enumeration),
    st.from_regex(r"[0-3][0-9A-F]{0,6}", fullmatch=True).map(Binary),
)
values: st.SearchStrategy[Value] = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4).map(tuple), st.builds(Typed, names, inner)
    ),
    max_leaves=12,
)
records = st.lists(values, max_size=4).map(tuple)
gaps = st.sampled_from([b"", b" ", b"\n", b"\r\n\t", b"/* c */", b"/* #1=A('; */", b" /**/ \n"])


def shape(value: Value) -> object:
    """The value with the type of each part, so that #1, 1 and 1. differ."""
    if isinstance(value, tuple):
        return tuple(shape(item) for item in value)
    if isinstance(value, Typed):
        return (value.keyword, shape(value.value))
    return (type(value).__name__, repr(value))


@given(texts)
def test_every_text_comes_back(text: str) -> None:
    assert encode(text).isascii()
    assert decode(encode(text)) == text


@given(records)
def test_every_value_comes_back(record: tuple[Value, ...]) -> None:
    text = "#1=A" + format_value(record).decode() + ";"
    parsed = parse_record(text.removeprefix("#1="))
    assert parsed.error is None
    assert not parsed.slips
    assert shape(parsed.parts[0][1]) == shape(record)
    assert len(parsed.spans) == len(record)
    if is_tidy(text):
        assert shape(tidy_values(text)) == shape(record)


@given(st.text(st.sampled_from("A1.E+-#'\"$*(), \n/*!x"), max_size=30))
def test_both_parsers_agree_on_what_is_tidy(inner: str) -> None:
    text = f"#1=A({inner});"
    if is_tidy(text):
        parsed = parse_record(text.removeprefix("#1="))
        assert parsed.error is None
        assert not parsed.slips
        assert shape(parsed.parts[0][1]) == shape(tidy_values(text))


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_every_real_is_written_with_a_point_and_comes_back(number: float) -> None:
    text = format_value(Real(number)).decode()
    assert re.fullmatch(r"-?\d+\.\d*(E[+-]?\d+)?", text)
    assert repr(float(text)) == repr(number)


@given(
    st.dictionaries(st.integers(1, 10**6), st.tuples(names, records), max_size=6),
    st.lists(gaps, min_size=6, max_size=6),
)
def test_every_file_comes_back(
    instances: dict[int, tuple[str, tuple[Value, ...]]], gap: list[bytes]
) -> None:
    a, b, c, d, e, f = gap
    lines = [
        b + b"#%d" % id + c.replace(b"/", b" ")[:0] + b"=" + d + name.encode() + e
        + format_value(record) + f + b";" + a
        for id, (name, record) in instances.items()
    ]  # fmt: skip
    data = HEAD + b"".join(lines) + b"\n" + TAIL
    file = Part21File.from_bytes(data)
    assert list(file.ids()) == list(instances)
    assert file.findings == ()
    for id, (name, record) in instances.items():
        assert file.keyword(id) == name
        assert shape(file.parameters(id)) == shape(record)
        spans = file.parameter_spans(id)
        assert [data[i:j] for i, j in spans] == [format_value(value) for value in record]
    assert Edits(file).apply() == data


@given(st.data())
def test_splice_changes_only_the_parameter(data: st.DataObject) -> None:
    edits = Edits(Part21File.from_bytes(SAMPLE))
    id = data.draw(st.sampled_from([1, 3, 40]))
    spans = edits.file.parameter_spans(id)
    position = data.draw(st.integers(0, len(spans) - 1))
    value = data.draw(values)
    edits.replace_parameter(id, position, value)
    start, end = spans[position]
    assert edits.apply() == SAMPLE[:start] + format_value(value) + SAMPLE[end:]


def originals() -> list[bytes]:
    paths = [p for p in sorted(CORPUS.glob("*/*")) if p.suffix in {".stp", ".p21", ".stpnc"}]
    return [SAMPLE, *(path.read_bytes() for path in paths)]


def exercise(file: Part21File) -> None:
    """Use all that a file offers; only malformed instances may refuse."""
    assert isinstance(file.schemas, tuple)
    edits = Edits(file)
    added = edits.add("ADDED", ())
    for id in file.ids():
        assert file.line(id) >= 1
        assert file.data[slice(*file.span(id))].startswith(b"#")
        try:
            if file.keyword(id):
                file.parameters(id)
            else:
                file.parts(id)
        except Part21Error:
            assert any(f.entity == file.label(id) for f in file.findings)
    again = Part21File.from_bytes(edits.apply())
    assert list(again.ids()) == [*file.ids(), added]


def account(original: Part21File, file: Part21File) -> None:
    """No instance whose head is still there is lost silently; an id may have changed."""
    heads = {int(digits) for digits in re.findall(rb"#(\d+)\s*=", file.data)}
    lost, gained = set(original.ids()) - set(file.ids()), set(file.ids()) - set(original.ids())
    assert not lost & heads or file.findings or len(lost) == len(gained) == 1


MARKS = [b"'", b'"', b"/*", b"*/", b"(", b")", b";", b"=", b"#", b"#1=", b",", b".", b"\\"]
MARKS += [b"''", b"\0", b"\xff", b"ENDSEC;", b"DATA;", b"#999999=X();", b"END-ISO-10303-21;"]
ORIGINALS = originals()
places = st.integers(0, 10**6).map(lambda part: part / 10**6)
damaged = settings(
    max_examples=120, deadline=None, suppress_health_check=[HealthCheck.data_too_large]
)


@damaged
@given(st.sampled_from(range(len(ORIGINALS))), places, st.binary(max_size=2))
def test_damaged_copy_is_read_or_refused_and_loses_nothing_silently(
    which: int, where: float, instead: bytes
) -> None:
    original = ORIGINALS[which]
    offset = int(where * (len(original) - 1))
    mutant = original[:offset] + instead + original[offset + 1 :]
    try:
        file = Part21File.from_bytes(mutant)
    except Part21Error:
        return
    account(Part21File.from_bytes(original), file)
    exercise(file)


@damaged
@given(st.sampled_from(range(len(ORIGINALS))), places)
def test_truncated_copy_is_refused_or_its_end_is_missed(which: int, where: float) -> None:
    original = ORIGINALS[which].rstrip()
    cut = original[: int(where * (len(original) - 1))]
    try:
        file = Part21File.from_bytes(cut)
    except Part21Error:
        return
    assert any("missing" in finding.message for finding in file.findings)
    exercise(file)


@damaged
@given(
    st.sampled_from(range(len(ORIGINALS))),
    places,
    st.sampled_from(MARKS),
)
def test_inserted_mark_loses_nothing_silently(which: int, where: float, mark: bytes) -> None:
    original = ORIGINALS[which]
    offset = int(where * len(original))
    try:
        file = Part21File.from_bytes(original[:offset] + mark + original[offset:])
    except Part21Error:
        return
    account(Part21File.from_bytes(original), file)


@given(st.binary(max_size=60))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    for prefix in (b"", b"ISO-10303-21;", HEAD, HEAD + b"#1=A("):
        try:
            file = Part21File.from_bytes(prefix + data)
        except Part21Error:
            continue
        exercise(file)


@pytest.mark.parametrize("original", ORIGINALS, ids=lambda data: f"{len(data)} bytes")
def test_sample_is_in_order(original: bytes) -> None:
    assert Part21File.from_bytes(original).findings == ()
