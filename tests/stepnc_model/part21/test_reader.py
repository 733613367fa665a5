"""Each tolerance of the reader by name, and each refusal."""

from pathlib import Path

import pytest

from stepnc_model.errors import Part21Error
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import DERIVED, Binary, Enumeration, Real, Ref, Typed

SHARED = Path(__file__).parents[4] / "shared"
CORPUS = sorted(
    path
    for path in (SHARED / "corpus").glob("*/*")
    if path.suffix in {".stp", ".p21", ".stpnc"}
)
needs_corpus = pytest.mark.skipif(not CORPUS, reason="the shared corpus is not there")

HEADER = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('a part'),'2;1');\n"
    "FILE_NAME('part.stp','2024-01-01',('A. Author'),('Shop'),'pre','sys','auth');\n"
    "FILE_SCHEMA(('MACHINING_SCHEMA','MILLING_SCHEMA'));\nENDSEC;\n"
)
END = "ENDSEC;\nEND-ISO-10303-21;\n"


def file_of(*instances: str, header: str = HEADER, end: str = END) -> Part21File:
    lines = "".join(f"{instance}\n" for instance in instances)
    return Part21File.from_bytes((header + "DATA;\n" + lines + end).encode("latin-1"))


def messages(file: Part21File) -> list[str]:
    return [finding.message for finding in file.findings]


def test_ordinary_file_has_no_findings() -> None:
    file = file_of("#1=DIRECTION('',(0.,0.,1.));", "#2=PLANE('p',#1);")
    assert list(file.ids()) == [1, 2]
    assert len(file) == 2
    assert 1 in file
    assert 3 not in file
    assert file.findings == ()
    assert file.schemas == ("MACHINING_SCHEMA", "MILLING_SCHEMA")
    assert file.label(2) == "#2 PLANE"
    assert file.line(1) == 8


def test_every_kind_of_value_is_read() -> None:
    file = file_of(
        "#1=A(1,-2,+3,4.,-5.5E-07,'s','',.CLIMB.,.T.,$,*,\"0A3F\",#7,(),(1,(2)),L_M(0.01),!X('v'));"
    )
    assert file.parameters(1) == (
        1,
        -2,
        3,
        Real(4.0),
        Real(-5.5e-7),
        "s",
        "",
        Enumeration("CLIMB"),
        Enumeration("T"),
        None,
        DERIVED,
        Binary("0A3F"),
        Ref(7),
        (),
        (1, (2,)),
        Typed("L_M", Real(0.01)),
        Typed("!X", "v"),
    )
    assert file.findings == ()


def test_reals_keep_their_characters() -> None:
    values = file_of("#1=A(1.50,-0.,1.E+06,0010.);").parameters(1)
    assert [v.lexeme for v in values if isinstance(v, Real)] == [
        "1.50",
        "-0.",
        "1.E+06",
        "0010.",
    ]


def test_real_out_of_range_keeps_its_characters_and_is_infinite() -> None:
    (value,) = file_of("#1=A(1.0E400);").parameters(1)
    assert isinstance(value, Real)
    assert value == float("inf")
    assert value.lexeme == "1.0E400"


def test_comments_before_the_opening_and_in_header_parameters() -> None:
    header = "/* by hand */\n\n" + HEADER.replace(
        "FILE_NAME('part", "FILE_NAME(/* name */ 'part"
    )
    file = file_of("#1=A();", header=header)
    assert file.findings == ()


def test_comments_within_an_instance() -> None:
    file = file_of(
        "#1= /* c */ A /* (d */ ( /* 1, */ 2 /* ; */ , 'x' /* ' */ ) /* e */ ;", "#2=B();"
    )
    assert file.parameters(1) == (2, "x")
    assert file.keyword(1) == "A"
    spans = file.parameter_spans(1)
    assert [file.data[a:b] for a, b in spans] == [b"2", b"'x'"]
    assert file.findings == ()


def test_instance_commented_out_with_the_same_id_is_not_read() -> None:
    file = file_of("#1=A(1);", "/* #1=A(2); */", "#2=B(/* #3=C(); */ 5);")
    assert list(file.ids()) == [1, 2]
    assert file.findings == ()


def test_instance_over_several_lines_with_crlf() -> None:
    file = file_of("#1=A(1,\r\n  2,\r\n  'x')\r\n;\r", "#2=B();\r")
    assert file.parameters(1) == (1, 2, "x")
    assert file.line(2) == 12


def test_carriage_returns_alone_end_lines() -> None:
    file = Part21File.from_bytes(
        (HEADER + "DATA;\n#1=A();\n" + END).replace("\n", "\r").encode()
    )
    assert file.line(1) == 8


def test_ids_unordered_with_gaps() -> None:
    file = file_of("#900=A();", "#7=B();", "#0100=A();")
    assert list(file.ids()) == [900, 7, 100]
    assert list(file.ids_of("a")) == [900, 100]
    assert list(file.ids_of("NOT_THERE")) == []


def test_doubled_apostrophe_semicolon_and_comment_marks_in_strings() -> None:
    file = file_of("#1=A('it''s; /* no */ comment','',''';''');", "#2=B('a''');")
    assert file.parameters(1) == ("it's; /* no */ comment", "", "';'")
    assert file.parameters(2) == ("a'",)
    assert file.findings == ()


def test_text_like_an_instance_in_a_string_is_text() -> None:
    file = file_of("#1=A('HOLE #2=B(); and\n#3=C();\n');", "#4=D('#5');")
    assert list(file.ids()) == [1, 4]
    assert file.parameters(1) == ("HOLE #2=B(); and#3=C();",)


def test_string_over_two_lines_is_one_string() -> None:
    assert file_of("#1=A('one\r\ntwo');").parameters(1) == ("onetwo",)


def test_byte_order_mark_and_latin_1_bytes() -> None:
    data = b"\xef\xbb\xbf" + (HEADER + "DATA;\n#1=A('Fr\xe4ser');\n" + END).encode("latin-1")
    file = Part21File.from_bytes(data)
    assert file.parameters(1) == ("Fräser",)


def test_utf_8_bytes() -> None:
    data = (HEADER + "DATA;\n#1=A('Fräser');\n" + END).encode()
    assert Part21File.from_bytes(data).parameters(1) == ("Fräser",)


def test_lower_case_keywords() -> None:
    text = HEADER.lower() + "data;\n#1=direction('',(0.,0.,.t.));\n" + END.lower()
    file = Part21File.from_bytes(text.encode())
    assert file.keyword(1) == "DIRECTION"
    assert file.parameters(1) == ("", (0.0, 0.0, Enumeration("T")))
    assert file.schemas == ("machining_schema", "milling_schema")
    assert list(file.ids_of("DIRECTION")) == [1]


@pytest.mark.parametrize(
    ("end", "missing"),
    [
        ("END-ISO-10303-21;", ["ENDSEC is missing after the DATA section"]),
        ("ENDSEC;", ["END-ISO-10303-21 is missing"]),
        ("", ["ENDSEC is missing after the DATA section", "END-ISO-10303-21 is missing"]),
        ("ENDSEC END-ISO-10303-21;", ["';' is missing after ENDSEC"]),
    ],
)
def test_missing_end_is_a_finding(end: str, missing: list[str]) -> None:
    file = file_of("#1=A();", end=end)
    assert len(file) == 1
    assert messages(file) == missing


def test_missing_endsec_of_the_header() -> None:
    file = file_of("#1=A();", header=HEADER.removesuffix("ENDSEC;\n"))
    assert messages(file) == ["ENDSEC is missing after the HEADER section"]


def test_edition_2_data_with_name_and_several_sections() -> None:
    text = HEADER + "DATA('one',('S'));\n#1=A();\nENDSEC;\nDATA ('two',('S'));\n#2=B();\n" + END
    file = Part21File.from_bytes(text.encode())
    assert list(file.ids()) == [1, 2]
    assert file.findings == ()


def test_edition_3_sections_hold_no_instances() -> None:
    extra = "ANCHOR;\n<a>=#1;\nENDSEC;\nREFERENCE;\n#9=<part.stp#it's>;\nENDSEC;\n"
    signature = "ENDSEC;\nEND-ISO-10303-21;\n"
    text = HEADER + extra + "DATA;\n#1=A();\nENDSEC;\nSIGNATURE;\nMII/ab//E=\n" + signature
    file = Part21File.from_bytes(text.encode())
    assert list(file.ids()) == [1]
    assert file.findings == ()


def test_user_defined_keyword_and_complex_instance() -> None:
    file = file_of("#1=!SHOP_NOTE('x');", "#2=(A(1)B_C('y',#1)\nD());")
    assert file.keyword(1) == "!SHOP_NOTE"
    assert file.keyword(2) == ""
    assert file.parts(1) == (("!SHOP_NOTE", ("x",)),)
    assert file.parts(2) == (("A", (1,)), ("B_C", ("y", Ref(1))), ("D", ()))
    assert file.findings == ()
    with pytest.raises(Part21Error, match="#2 is a complex instance"):
        file.parameters(2)


def test_header_with_the_wrong_arity_is_read_as_far_as_it_goes() -> None:
    statements = "FILE_DESCRIPTION(' ');\nFILE_NAME('n',$);\nFILE_SCHEMA('S');\n"
    header = f"ISO-10303-21;\nHEADER;\n{statements}ENDSEC;\n"
    file = file_of("#1=A();", header=header)
    assert file.schemas == ("S",)
    assert messages(file) == [
        "FILE_DESCRIPTION has 1 parameter instead of 2",
        "FILE_NAME has 2 parameters instead of 7",
    ]


def test_broken_header_is_never_fatal() -> None:
    header = "ISO-10303-21;\nHEADER;\nFILE_NAME('a' 'b');\nFILE_SCHEMA((;\nwhat\nENDSEC;\n"
    file = file_of("#1=A();", header=header)
    assert list(file.ids()) == [1]
    assert file.schemas == ()
    assert file.findings


def test_schema_list_span_lies_between_the_inner_brackets() -> None:
    file = file_of(
        "#1=A();", header=HEADER.replace("FILE_SCHEMA((", "FILE_SCHEMA ( /* ( */ ( ")
    )
    start, end = file.schema_list_span()
    assert file.data[start:end] == b" 'MACHINING_SCHEMA','MILLING_SCHEMA'"


def test_figure_11_of_paper_002_is_readable_as_printed() -> None:
    paper = SHARED / "seeds" / "002_489edeab1a316dc9.txt"
    if not paper.exists():
        pytest.skip("the shared paper is not there")
    text = paper.read_text()
    start = text.index("ISO-10303-21;")
    file = Part21File.from_bytes(text[start : text.index("```", start)].encode())
    assert list(file.ids()) == [20, 39, 29, 30, 125, 40, 42, 43, 60, 61, *range(200, 205)]
    assert file.parameters(29)[1:4] == (4.0, Enumeration("RIGHT"), Enumeration("F"))
    assert file.parameters(204) == (180.0, "FULL_IMMERSION")
    assert file.parameters(202) == ("CUTTING POWER", None, "kW", Ref(203), 35)
    assert [(f.line, f.message) for f in file.findings] == [
        (3, "FILE_DESCRIPTION has 1 parameter instead of 2"),
        (4, "FILE_NAME has 1 parameter instead of 7"),
        (7, "text outside any instance: '. . .'"),
        (11, "nested comment: '/*' within a comment"),
        (13, "text outside any instance: '*****/'"),
        (14, "instances outside a DATA section: 'DATA;' is missing"),
        (16, "RIGHT: read as .RIGHT."),
        (16, "..F.: an enumeration must have one dot on each side"),
        (24, "nested comment: '/*' within a comment"),
        (26, "text outside any instance: '*****/'"),
        (29, "';' is missing after #202"),
        (30, "';' is missing after #203"),
        (31, '"FULL_IMMERSION": double quotes enclose binary values; read as a string'),
        (31, "';' is missing after #204"),
        (32, "text outside any instance: '. . .'"),
    ]


@needs_corpus
@pytest.mark.parametrize("path", CORPUS, ids=lambda path: path.name)
def test_corpus_file_is_read_without_findings(path: Path) -> None:
    file = Part21File.from_bytes(path.read_bytes())
    assert file.findings == ()
    for id in file.ids():
        assert all(keyword for keyword, _ in file.parts(id))


@needs_corpus
def test_ex1_has_105_instances() -> None:
    path = SHARED / "corpus" / "iso14649" / "ex1.stp"
    assert len(Part21File.from_bytes(path.read_bytes())) == 105
