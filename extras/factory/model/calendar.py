"""Shifts: weekly hours in which a machine or a crew works. Times in s since Monday, 0:00."""

import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from stepnc_model.units import seconds_from_hours, seconds_from_minutes

DAY = 86_400.0
WEEK = 7 * DAY
DAYS = ("Mon", "Tue", "Wed", "Thu", "Fri", "Sat", "Sun")

_WINDOW = re.compile(r"(\w{3})(?:-(\w{3}))? (\d{1,2}):(\d{2})-(\d{1,2}):(\d{2})")
_MOMENT = re.compile(r"(\w{3}) (\d{1,2}):(\d{2})")


@dataclass(frozen=True, slots=True, kw_only=True)
class Calendar:
    """Weekly working hours."""

    windows: tuple[tuple[float, float], ...]
    """Begin and end of each window within a week, s; ascending, apart from each other."""

    def is_open(self, time: float) -> bool:
        """True if a time lies within the working hours; an end does not."""
        at = time % WEEK
        row = bisect_right(self.windows, at, key=lambda window: window[0]) - 1
        return row >= 0 and at < self.windows[row][1]

    def next_change(self, time: float) -> float:
        """First time after the given one at which the working hours begin or end, s."""
        week, at = time - time % WEEK, time % WEEK
        for begin, end in self.windows:
            for edge in (begin, end):
                if edge > at:
                    return week + edge
        return week + WEEK + self.windows[0][0]

    @property
    def weekly(self) -> float:
        """Working time of a week, s."""
        return sum(end - begin for begin, end in self.windows)


def calendar_of(lines: Sequence[str]) -> Calendar:
    """Calendar of lines such as ``Mon-Fri 06:00-14:00``.

    A window that ends before it begins runs into the next day; windows that touch become one.

    Raises
    ------
    ValueError
        If a line has another form, or a day or an hour does not exist.
    """
    parts: list[tuple[float, float]] = []
    for line in lines:
        found = _WINDOW.fullmatch(line.strip())
        if found is None:
            raise ValueError(f"'{line}': expected days and hours as 'Mon-Fri 06:00-14:00'")
        first, last = _day(found[1], line), _day(found[2] or found[1], line)
        begin, end = _clock(found[3], found[4], line), _clock(found[5], found[6], line)
        end += DAY if end <= begin else 0.0
        for day in range(first, last + 1 + (7 if last < first else 0)):
            parts += _within_week((day % 7) * DAY + begin, (day % 7) * DAY + end)
    if not parts:
        raise ValueError("no hours")
    merged: list[tuple[float, float]] = []
    for begin, end in sorted(parts):
        if merged and begin <= merged[-1][1]:
            merged[-1] = (merged[-1][0], max(end, merged[-1][1]))
        else:
            merged.append((begin, end))
    return Calendar(windows=tuple(merged))


def moment(text: str) -> float:
    """Time of the week of a text such as ``Mon 06:00``, s.

    Raises
    ------
    ValueError
        If the text has another form.
    """
    found = _MOMENT.fullmatch(text.strip())
    if found is None:
        raise ValueError(f"'{text}': expected a day and an hour as 'Mon 06:00'")
    return _day(found[1], text) * DAY + _clock(found[2], found[3], text)


def _within_week(begin: float, end: float) -> list[tuple[float, float]]:
    if end <= WEEK:
        return [(begin, end)]
    return [(begin, WEEK), (0.0, end - WEEK)]


def _day(word: str, line: str) -> int:
    if word not in DAYS:
        raise ValueError(f"'{line}': unknown day '{word}'; known: {', '.join(DAYS)}")
    return DAYS.index(word)


def _clock(hours: str, minutes: str, line: str) -> float:
    seconds = seconds_from_hours(int(hours)) + seconds_from_minutes(int(minutes))
    if int(minutes) >= 60 or seconds > DAY:
        raise ValueError(f"'{line}': {hours}:{minutes} is no time of a day")
    return seconds
