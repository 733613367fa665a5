"""Pages from templates: everything that is filled in is escaped."""

from service.rendering.pages import findings, rendered
from stepnc_model.errors import Finding, Severity

EVIL = "<script>alert(1)</script>"


def test_what_is_filled_in_is_escaped() -> None:
    page = rendered(
        "evaluation.html.jinja",
        place=EVIL,
        made_at="",
        filters=[EVIL],
        figures=[(EVIL, EVIL)],
        columns=(),
        lines=(),
        remarks=(),
        legend=EVIL,
    )
    assert "<script" not in page
    assert page.count("&lt;script&gt;alert(1)") == 5


def test_equal_findings_are_told_once() -> None:
    one = Finding(severity=Severity.NOTE, message="a")
    assert findings([one, one]) == [("note", str(one))]
