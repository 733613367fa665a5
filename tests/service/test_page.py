"""A page is whole, fetches nothing, and no word of a file becomes markup."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from service.page import bullets, clock, headline, page, table


def test_a_page_fetches_nothing() -> None:
    text = page("<title>", "<p>body</p>")
    own = re.sub(r"<script>.*?</script>", "", text, count=1, flags=re.DOTALL)
    assert "&lt;title&gt;" in own
    assert own.endswith("<p>body</p>\n</body></html>\n")
    assert not re.search(r"https?:|src=|href=", own)


@given(word=st.text(alphabet="<>&\"'ab/"))
def test_words_never_become_markup(word: str) -> None:
    shown = (
        table((word,), [(word,)], [(word,)])
        + bullets([("bad", word)])
        + headline([(word, word)])
    )
    known = r"</?(div|b|ul|li|p|table|thead|tbody|tfoot|tr|th|td)( class=\"\w+\")?>"
    assert not re.search(r"[<>]", re.sub(known, "", shown))


def test_an_empty_list_says_so() -> None:
    assert bullets(()) == "<p>none</p>"


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.04, "0.0 s"),
        (119.9, "119.9 s"),
        (120.0, "2 min 00 s"),
        (3599.7, "1 h 00 min"),
        (90_000.0, "25 h 00 min"),
    ],
)
def test_time_is_told_as_people_do(seconds: float, words: str) -> None:
    assert clock(seconds) == words
