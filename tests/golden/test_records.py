"""Every verb prints, writes and answers what it did."""

import pytest

from tests.golden.record import FADING, RECORDS, RELATIVE, differences, recorded
from tests.golden.stories import STORIES


@pytest.mark.parametrize("story", STORIES)
def test_a_story_goes_as_it_is_recorded(story: str) -> None:
    old = (RECORDS / f"{story}.txt").read_text(encoding="utf-8")
    relative = FADING.get(story, RELATIVE)
    assert list(differences(old, recorded(story), relative)) == []
