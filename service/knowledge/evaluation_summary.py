"""The summary of outcomes, as the database makes it: on a terminal and for other programs.

Counts, means and spreads by machine, material, tool and kind of feature, in per cent.
"""

from collections.abc import Iterator, Sequence
from datetime import datetime

from kbe.groups import Group, Spread
from kbe.statistics import Evaluated
from service.flat_file import Field, Row, Value
from service.knowledge.evaluated import Summary
from service.knowledge.evaluation_cells import NOTHING
from service.knowledge.evaluation_table import plain
from service.knowledge.table import local
from service.tables import print_line, print_table
from service.wire import dump

SPREADS = ("count", "mean_percent", "deviation_percent")

SUMMARY_FIELDS = (
    Field(name="machine", kind=str),
    Field(name="material", kind=str),
    Field(name="tool", kind=str),
    Field(name="feature_kind", kind=str),
    Field(name="outcomes", kind=int),
    Field(name="first", kind=datetime),
    Field(name="last", kind=datetime),
    *(Field(name=f"{which}_{name}", kind=int if name == "count" else float)
      for which in Evaluated for name in SPREADS),
)  # fmt: skip


def print_summary(summary: Summary) -> None:
    """A line for each machine, material, tool and kind of feature."""
    header = (
        "machine", "material", "tool", "kind", "outcomes", "first", "last", "surface %",
        "time %", "force %", "feed %",
    )  # fmt: skip
    rows = [
        (
            *map(plain, (group.context.machine, group.context.material, group.context.tool)),
            plain(group.feature_kind),
            str(group.outcomes),
            local(group.first),
            local(group.last),
            *(_spread(spread) for _, spread in spreads(group)),
        )
        for group in summary.groups
    ]
    print_table(header, rows)
    count = sum(group.outcomes for group in summary.groups)
    print_line(
        f"{summary.place}: {count} outcomes; mean ± standard deviation of measured over "
        "planned, less one"
    )


def summary_rows(groups: Sequence[Group]) -> Iterator[Row]:
    """A flat line for each group."""
    for group in groups:
        context = group.context
        yield {
            "machine": context.machine,
            "material": context.material,
            "tool": context.tool,
            "feature_kind": group.feature_kind,
            "outcomes": group.outcomes,
            "first": group.first,
            "last": group.last,
            **{
                f"{which}_{name}": value
                for which, spread in spreads(group)
                for name, value in zip(SPREADS, _values(spread), strict=True)
            },
        }


def summary_json(summary: Summary) -> str:
    """The summary with what it was made from."""
    groups = [
        {
            name: value.isoformat() if isinstance(value, datetime) else value
            for name, value in row.items()
        }
        for row in summary_rows(summary.groups)
    ]
    return dump({
        "place": summary.place,
        "made_at": summary.made_at.isoformat(),
        "groups": groups,
    })


def spreads(group: Group) -> tuple[tuple[Evaluated, Spread], ...]:
    """The four quantities of a group."""
    return (
        (Evaluated.ROUGHNESS, group.roughness),
        (Evaluated.TIME, group.time),
        (Evaluated.FORCE, group.force),
        (Evaluated.FEED, group.feed),
    )


def _values(spread: Spread) -> tuple[Value, Value, Value]:
    mean, scatter = (
        None if each is None else 100.0 * each for each in (spread.mean, spread.deviation)
    )
    return spread.count, mean, scatter


def _spread(spread: Spread) -> str:
    if spread.mean is None:
        return NOTHING
    scatter = "" if spread.deviation is None else f" ± {100.0 * spread.deviation:.0f}"
    return f"{round(100.0 * spread.mean) + 0:+d}{scatter}"
