"""Output of feeds along the paths: text, JSON, and a table of the profile as CSV."""

from collections.abc import Iterator
from typing import Any

from service.along_path.run import AlongPathStep, FeedsAlongPath
from service.rendering.columns import Change, Column
from service.rendering.view import Item, Table, TextLine
from stepnc_model.plurals import counted
from stepnc_model.units import kw_from_watts, mm_min_from_speed, um_from_mm

STEP: tuple[Column[AlongPathStep], ...] = (
    Column(key="id", heading="part of the program", value=lambda step: step.name, is_key=True),
    Column(
        key="time_s", heading="time s", form=".1f",
        value=lambda step: Change(before=step.before.duration, after=step.after.duration),
    ),
    Column(
        key="planned_time_s", heading="run/plan", form=".4f",
        value=lambda step: step.after.duration / step.planned_time
        if step.planned_time > 0.0
        else None,
    ),
    Column(
        heading="air s", form=".1f",
        value=lambda step: Change(before=step.before.air_time, after=step.after.air_time),
    ),
    Column(
        heading="force N", form=".0f",
        value=lambda step: Change(
            before=step.before.force.value, after=step.after.force.value
        ),
    ),
    Column(
        heading="bent µm", form=".1f",
        value=lambda step: Change(
            before=um_from_mm(step.before.deflection.value),
            after=um_from_mm(step.after.deflection.value),
        ),
    ),
    Column(
        heading="drive kW", form=".2f",
        value=lambda step: Change(
            before=kw_from_watts(step.before.drive_power.value),
            after=kw_from_watts(step.after.drive_power.value),
        ),
    ),
    Column(
        heading="removed cm³", form=".3f",
        value=lambda step: Change(
            before=step.before.volume / 1e3, after=step.after.volume / 1e3
        ),
    ),
    Column(
        heading="feeds", value=lambda step: None if step.plan is None else step.plan.feeds
    ),
    Column(
        heading="above least time", form=".1%",
        value=lambda step: None if step.plan is None else step.plan.gap,
    ),
)  # fmt: skip
"""Columns of the comparison of one feed per part with feeds along its path."""


def along_path_items(along: FeedsAlongPath) -> Iterator[Item]:
    """Yield the comparison of both runs, and what limits the feed along the path."""
    yield TextLine(text="one feed per part -> along the path, both run on the virtual machine")
    total = f"{along.time_before:.1f} -> {along.time_after:.1f}"
    yield Table(
        key="parts", columns=STEP, rows=along.shown, is_in_json=False,
        foot={"part of the program": "total", "time s": total},
    )  # fmt: skip
    ratio = along.time_after / along.time_before if along.time_before else 1.0
    to_plan = along.time_after / along.planned_time if along.planned_time else 1.0
    yield TextLine(
        text=f"time × {ratio:.3f}; {counted(len(along.feeds), 'block')} changed, "
        f"{counted(along.parts, 'split')}; run/plan {to_plan:.4f}"
    )
    yield TextLine(text=free_words(along))
    shares = ", ".join(f"{words} {share:.0%}" for words, share in active_shares(along))
    yield TextLine(text=f"share of the path by active limit: {shares}")


def free_words(along: FeedsAlongPath) -> str:
    """State what the cut takes without a control, and how far limits are exceeded."""
    free = along.free
    chosen = sum(step.plan.time for step in along.steps if step.plan is not None)
    text = (
        f"moves with a chosen feed: {chosen:.1f} s in blocks, {free.time:.1f} s as a free "
        f"profile within the accelerations of the axes (at least {free.bound:.1f} s"
    )
    if free.worst is not None:
        text += f"; greatest excess {free.worst.excess:.1e}, {free.worst.limit}"
    if free.jerk_time is not None:
        text += f"; {free.jerk_time:.1f} s with limited jerk"
    if free.smoothest is not None:
        smooth = free.smoothest
        text += (
            f"; {smooth.time:.1f} s as the smoothest profile, whose squared changes of the "
            f"acceleration are {smooth.ratio:.3g} times those of the fastest, "
            f"{smooth.fastest_time:.1f} s"
        )
    return text + ")"


def active_shares(along: FeedsAlongPath) -> list[tuple[str, float]]:
    """Share of the chosen path length at each active limit, the greatest first."""
    lengths: dict[str, float] = {}
    for step in along.steps:
        for name, (length, _) in (step.plan.shares if step.plan else {}).items():
            lengths[name.words] = lengths.get(name.words, 0.0) + length
    whole = sum(lengths.values())
    ordered = sorted(lengths.items(), key=lambda pair: -pair[1])
    return [(words, length / whole) for words, length in ordered] if whole > 0.0 else []


def along_path_record(along: FeedsAlongPath) -> dict[str, Any]:
    """Return the feeds along the paths as a JSON object."""
    return {
        "time_s": {"before": along.time_before, "after": along.time_after},
        "planned_time_s": along.planned_time,
        "blocks": len(along.feeds),
        "splits": along.parts,
        "free_profile": _free(along),
        "active_limits": dict(active_shares(along)),
        "parts": [_step(step) for step in along.shown],
    }


def _free(along: FeedsAlongPath) -> dict[str, Any]:
    free = along.free
    worst, smooth = free.worst, free.smoothest
    return {
        "time_s": free.time,
        "bound_s": free.bound,
        "jerk_limited_time_s": free.jerk_time,
        "smoothest": None
        if smooth is None
        else {
            "time_s": smooth.time,
            "fastest_time_s": smooth.fastest_time,
            "unevenness_ratio": smooth.ratio,
        },
        "greatest_excess": None if worst is None else worst.excess,
        "greatest_excess_limit": None if worst is None else worst.limit,
    }


def _step(step: AlongPathStep) -> dict[str, Any]:
    plan = step.plan
    return {
        "id": step.name,
        "time_s": {"before": step.before.duration, "after": step.after.duration},
        "planned_time_s": step.planned_time,
        "bound_s": None if plan is None else plan.bound,
        "feeds": None if plan is None else plan.feeds,
        "levels_gap": None if plan is None else plan.levels_gap,
        "gap": None if plan is None else plan.gap,
        **{
            key: {"before": scale * before, "after": scale * after}
            for key, scale, before, after in (
                ("force_n", 1.0, step.before.force.value, step.after.force.value),
                ("thrust_n", 1.0, step.before.thrust.value, step.after.thrust.value),
                (
                    "deflection_um",
                    1e3,
                    step.before.deflection.value,
                    step.after.deflection.value,
                ),
                (
                    "drive_power_w",
                    1.0,
                    step.before.drive_power.value,
                    step.after.drive_power.value,
                ),
                ("energy_j", 1.0, step.before.energy.total, step.after.energy.total),
                ("volume_mm3", 1.0, step.before.volume, step.after.volume),
            )
        },
        "active_limits": {
            name.value: {"length_mm": length, "time_s": seconds}
            for name, (length, seconds) in (plan.shares if plan else {}).items()
        },
    }


PROFILE = "block,part,end_of_block,feed,unit,limit\n"
"""Header of the profile as CSV."""


def profile_lines(along: FeedsAlongPath) -> Iterator[str]:
    """Yield the feeds of the changed blocks as lines of a CSV table."""
    yield PROFILE.rstrip()
    for block, parts in along.feeds.items():
        for number, part in enumerate(parts, 1):
            value = part.rate if part.is_per_revolution else mm_min_from_speed(part.rate)
            unit = "mm/rev" if part.is_per_revolution else "mm/min"
            yield f"{block},{number},{part.end:.6f},{value:.6g},{unit},{part.reason}"
