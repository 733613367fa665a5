"""Writing: values as text, and edits that touch only what they name."""

from pathlib import Path

import pytest

from stepnc_model.errors import Part21Error
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import DERIVED, Binary, Enumeration, Real, Ref, Typed, Value
from stepnc_model.part21.writer import Edits, format_value
from tests.every_case import every_case

SHARED = Path(__file__).parents[4] / "shared"
CORPUS = sorted(
    path
    for path in (SHARED / "corpus").glob("*/*")
    if path.suffix in {".stp", ".p21", ".stpnc"}
)
needs_corpus = pytest.mark.skipif(not CORPUS, reason="the shared corpus is not there")

PLAIN = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
    "FILE_NAME('','',(''),(''),'','','');\nFILE_SCHEMA(('A','B'));\nENDSEC;\nDATA;\n"
    "#1=ONE(1, /* two */ 'x' /* end */ );\n"
    "#2=NONE();\n"
    "/* kept */\n"
    "#7= SEVEN(#1,(#2,\n   #1), $);\n"
    "#5=FIVE(.T.); #6=SIX(*);\n"
    "\nENDSEC;\nEND-ISO-10303-21;\n"
)


def edits_of(text: str = PLAIN) -> Edits:
    return Edits(Part21File.from_bytes(text.encode()))


@every_case(
    ("value", "text"),
    [
        (None, b"$"),
        (DERIVED, b"*"),
        (Ref(12), b"#12"),
        (-3, b"-3"),
        (Real(1.0), b"1."),
        (Real(-0.0), b"-0."),
        (Real(0.04), b"0.04"),
        (Real(1.5e-7), b"1.5E-07"),
        (Real(1e-7), b"1.E-07"),
        (Real(1e22), b"1.E+22"),
        (Real(2.5, "2.500"), b"2.500"),
        ("", b"''"),
        ("it's \u00e9", rb"'it''s \X2\00E9\X0\'"),
        (Enumeration("CLIMB"), b".CLIMB."),
        (Binary("0A3F"), b'"0A3F"'),
        (Typed("L_M", Real(0.5)), b"L_M(0.5)"),
        ((), b"()"),
        ((1, ("a", None), Typed("X", (2,))), b"(1,('a',$),X((2)))"),
    ],
)
def test_value_is_written_in_its_form(value: Value, text: bytes) -> None:
    assert format_value(value) == text


@every_case(
    "value",
    [Real(float("nan")), Real(float("inf")), Enumeration("a b"), Binary("9"), Typed("a b", 1)],
)
def test_value_without_a_form_is_refused(value: Value) -> None:
    with pytest.raises(ValueError, match=r"cannot be written|is no"):
        format_value(value)


def test_truth_value_of_python_is_refused() -> None:
    with pytest.raises(TypeError):
        format_value(True)


def test_deep_list_is_written_without_recursion() -> None:
    value: Value = ()
    for _ in range(5000):
        value = (value,)
    assert format_value(value) == b"(" * 5001 + b")" * 5001


def test_no_edits_give_the_same_bytes() -> None:
    assert edits_of().apply() == PLAIN.encode()


def test_replaced_parameter_changes_only_its_bytes() -> None:
    edits = edits_of()
    edits.replace_parameter(1, 1, "new")
    edits.replace_parameter(7, 1, Ref(5))
    edits.replace_parameter(7, 2, None)
    expected = PLAIN.replace("'x'", "'new'").replace("(#2,\n   #1)", "#5")
    assert edits.apply().decode() == expected


def test_replacing_a_parameter_by_itself_changes_nothing() -> None:
    edits = edits_of()
    for id in (1, 5, 6):
        for position, value in enumerate(edits.file.parameters(id)):
            edits.replace_parameter(id, position, value)
    assert edits.apply().decode() == PLAIN


def test_appended_parameter_stands_behind_the_last() -> None:
    edits = edits_of()
    edits.append_parameter(1, Ref(9))
    edits.append_parameter(2, 1)
    edits.append_parameter(2, 2)
    expected = PLAIN.replace("'x'", "'x', #9").replace("NONE()", "NONE(1, 2)")
    assert edits.apply().decode() == expected


def test_removing_an_appended_parameter_gives_the_file_back() -> None:
    edits = edits_of()
    for id in (1, 2, 5, 6, 7):
        edits.append_parameter(id, Ref(9))
    again = Edits(Part21File.from_bytes(edits.apply()))
    for id in (1, 2, 5, 6, 7):
        again.remove_parameter(id, len(again.file.parameters(id)) - 1)
    assert again.apply().decode() == PLAIN


def test_removed_and_appended_parameter_is_replaced() -> None:
    edits = edits_of()
    edits.remove_parameter(7, len(edits.file.parameters(7)) - 1)
    edits.append_parameter(7, Ref(2))
    assert edits.apply().decode() == PLAIN.replace(", $)", ", #2)")


def test_added_instances_stand_before_endsec_with_ids_above_the_largest() -> None:
    edits = edits_of()
    assert edits.next_id() == 8
    first = edits.add("EIGHT", (Real(0.5), "é"))
    second = edits.add("NINE", (first,))
    assert (first, second) == (Ref(8), Ref(9))
    assert edits.next_id() == 10
    lines = "#8=EIGHT(0.5,'\\X2\\00E9\\X0\\');\n#9=NINE(#8);\n"
    assert edits.apply().decode() == PLAIN.replace("ENDSEC;\nEND-", lines + "ENDSEC;\nEND-")


def test_added_instance_can_be_edited_and_removed() -> None:
    edits = edits_of()
    kept, dropped = edits.add("A", (1, 2)), edits.add("B", ())
    edits.replace_parameter(kept, 0, 3)
    edits.remove_parameter(kept, 1)
    edits.append_parameter(kept, 4)
    edits.remove(dropped)
    assert kept in edits
    assert dropped not in edits
    assert b"#8=A(3,4);\nENDSEC;" in edits.apply()


def test_removed_instance_takes_its_line_only_if_it_is_alone_there() -> None:
    edits = edits_of()
    edits.remove(7)
    edits.remove(5)
    expected = PLAIN.replace("#7= SEVEN(#1,(#2,\n   #1), $);\n", "").replace(
        "#5=FIVE(.T.);", ""
    )
    assert edits.apply().decode() == expected


@pytest.mark.parametrize(
    "tail", ["\nENDSEC;", "ENDSEC;", "\n\n  ENDSEC;", " /* c */ ENDSEC;", ""]
)
def test_write_back_is_idempotent(tail: str) -> None:
    head = PLAIN[: PLAIN.index("#7")] + "#7=SEVEN($);"
    data = (head + tail).encode()
    results = []
    for _ in range(3):
        edits = Edits(Part21File.from_bytes(data))
        for id in edits.file.ids():
            if id > 7:
                edits.remove(id)
        for name in ("A", "B"):
            edits.add(name, (edits.next_id(),))
        data = edits.apply()
        results.append(data)
    assert b"#8=A(8);\n#9=B(9);\n" in results[0]
    assert results[1:] == results[:1] * 2


def test_next_id_follows_what_is_kept() -> None:
    edits = edits_of()
    edits.remove(7)
    assert edits.next_id() == 7
    assert edits.add("A", ()) == Ref(7)
    assert b"SEVEN" not in edits.apply()


def test_line_ends_of_the_file_are_kept() -> None:
    edits = edits_of(PLAIN.replace("\n", "\r\n"))
    edits.remove(2)
    edits.add("A", ())
    result = edits.apply().decode()
    assert result == PLAIN.replace("#2=NONE();\n", "").replace(
        "ENDSEC;\nEND-", "#8=A();\nENDSEC;\nEND-"
    ).replace("\n", "\r\n")


def test_added_instances_go_into_the_last_of_several_sections() -> None:
    edits = edits_of(PLAIN.replace("/* kept */\n", "ENDSEC;\nDATA;\n"))
    edits.add("A", ())
    assert b"\n\n#8=A();\nENDSEC;\nEND-ISO" in edits.apply()


def test_added_instances_survive_a_missing_end() -> None:
    edits = edits_of(PLAIN[: PLAIN.index("\n\nENDSEC")])
    edits.add("A", ())
    assert edits.apply().endswith(b"#6=SIX(*);\n#8=A();\n")


@every_case(
    ("before", "name", "after"),
    [
        ("(('A','B'))", "C", "(('A','B', 'C'))"),
        ("(('A','B'))", "b", "(('A','B'))"),
        ("(())", "C", "(('C'))"),
        ("('A')", "C", "('A', 'C')"),
        ("((' '))", "C", "((' ', 'C'))"),
        ("( /* ( */ ('A { 1 0 }' ) )", "A", "( /* ( */ ('A { 1 0 }' ) )"),
    ],
)
def test_schema_is_added_once(before: str, name: str, after: str) -> None:
    edits = edits_of(PLAIN.replace("(('A','B'))", before))
    edits.add_schema(name)
    edits.add_schema(name)
    assert edits.apply().decode() == PLAIN.replace("(('A','B'))", after)


@pytest.mark.parametrize(
    ("name", "after"), [("A", "(('B'))"), ("B", "(('A'))"), ("C", "(('A','B'))")]
)
def test_schema_is_removed(name: str, after: str) -> None:
    edits = edits_of()
    edits.remove_schema(name)
    assert edits.apply().decode() == PLAIN.replace("(('A','B'))", after)


def test_added_schema_can_be_removed_without_a_trace() -> None:
    edits = edits_of()
    edits.add_schema("C")
    again = Edits(Part21File.from_bytes(edits.apply()))
    again.remove_schema("C")
    assert again.apply().decode() == PLAIN


def test_missing_file_schema_is_an_error() -> None:
    with pytest.raises(Part21Error, match="FILE_SCHEMA is missing"):
        edits_of(PLAIN.replace("FILE_SCHEMA(('A','B'));\n", "")).add_schema("C")


def test_edit_of_what_is_not_there_is_refused() -> None:
    edits = edits_of()
    edits.remove(1)
    for id in (1, 99):
        with pytest.raises(KeyError):
            edits.replace_parameter(id, 0, None)
        with pytest.raises(KeyError):
            edits.remove(id)
    with pytest.raises(IndexError, match="#5 has 1 parameters"):
        edits.replace_parameter(5, 1, None)
    with pytest.raises(IndexError, match="#2 has 0 parameters"):
        edits.remove_parameter(2, 0)
    with pytest.raises(ValueError, match="is not a valid keyword"):
        edits.add("A(B", ())


@needs_corpus
@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.name)
def test_corpus_file_survives_edit_and_undo(path: Path) -> None:
    data = path.read_bytes()
    edits = Edits(Part21File.from_bytes(data))
    assert edits.apply() == data
    simple = [id for id in edits.file.ids() if edits.file.keyword(id)]
    added = edits.add("ADDED", ("x",))
    for id in simple:
        edits.append_parameter(id, added)
    edits.add_schema("EXTRA_SCHEMA")
    again = Edits(Part21File.from_bytes(edits.apply()))
    assert again.file.findings == ()
    for id in simple:
        assert again.file.parameters(id)[-1] == added
        again.remove_parameter(id, len(again.file.parameters(id)) - 1)
    again.remove(added)
    again.remove_schema("EXTRA_SCHEMA")
    assert again.apply() == data


@needs_corpus
@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.name)
def test_corpus_values_are_written_as_they_were_read(path: Path) -> None:
    edits = Edits(Part21File.from_bytes(path.read_bytes()))
    for id in edits.file.ids():
        if edits.file.keyword(id):
            for position, value in enumerate(edits.file.parameters(id)):
                edits.replace_parameter(id, position, value)
    again = Part21File.from_bytes(edits.apply())
    assert [again.parts(id) for id in again.ids()] == [
        edits.file.parts(id) for id in edits.file.ids()
    ]
