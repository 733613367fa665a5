"""The control laws in the whole loop on the virtual machine, beside the trial of the notes.

Trials and figures: ``tests/closed_loop/trials.py``. What is in brackets is of the trial of the
design notes, a plant of the same numbers without a loop, noise or tooth periods around it.
``python -m benchmarks.closed_loop``
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.control_step import step_cost
from controller.laws.choice import LawName
from controller.signals.preview import LOOK_AHEAD
from simulator.plant.controlled_machine import Instrumentation
from simulator.plant.dynamometer import Instrument
from simulator.plant.hidden_behaviour import HiddenTruth
from tests.closed_loop.trials import (
    GUARDED,
    KNOWN,
    LAWS,
    LOST,
    REVOLUTION,
    SET_POINT,
    TRIALS,
    UNKNOWN,
    Run,
    Score,
    Trial,
    quiet,
    run,
    score,
    settled,
    unstable,
)

LOOK_AHEADS = (3, 6, 8, 12, 15)
FACTORS = (0.7, 1.0, 1.4)
LAGS = (1.5, 3.0, 6.0)
"""revolutions"""
OVERLOAD = 1.5
"""of the set point"""
NAMES = {trial: title for title, trial in TRIALS.items()}
PERFECT = Instrumentation(dynamometer=Instrument(), power_meter=Instrument())


@dataclass(frozen=True, slots=True, kw_only=True)
class Noted:
    """A row of the trial of the design notes."""

    peak: float
    """%"""
    settling: str
    """revolutions after entry, step up, step down"""
    rms: float
    """%"""
    step: float
    """µs"""
    unstable: int
    """of 15"""
    step_p99: str = ""
    """µs"""


NOTED: Mapping[tuple[LawName, bool], Noted] = {
    (LawName.PI, False): Noted(peak=99, settling="10/9/18", rms=12.4, step=2, unstable=0),
    (LawName.LOG_PI, False): Noted(peak=99, settling="11/7/12", rms=11.7, step=3, unstable=0),
    (LawName.MRAC, False): Noted(peak=98, settling="17/14/22", rms=17.4, step=1, unstable=0),
    (LawName.FUZZY, False): Noted(peak=98, settling="14/10/19", rms=16.2, step=7, unstable=0),
    (LawName.SELF_TUNING, False): Noted(
        peak=99, settling="10/12/15", rms=12.9, step=2, unstable=0
    ),
    (LawName.MPC, False): Noted(peak=99, settling="9/10/13", rms=12.0, step=55, unstable=3),
    (LawName.SELF_TUNING, True): Noted(peak=12, settling="11/8/9", rms=6.9, step=5, unstable=0),
    (LawName.MPC, True): Noted(
        peak=11, settling="10/6/6", rms=5.0, step=100, unstable=0, step_p99="375"
    ),
}
"""trial of the design notes; by law, and whether it had preview (6 revolutions or so)"""

NOTED_PEAKS = {3: 21, 6: 12, 9: 7, 12: 4, 15: 2}
"""%, by look-ahead, of the same trial; "for about 5 % less feed\""""


def main(arguments: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--look-ahead", type=int, default=LOOK_AHEAD)
    options = parser.parse_args(arguments)
    _compare(options.look_ahead)
    _try(options.look_ahead)
    _noise(options.look_ahead)
    _look_ahead()
    _guard(options.look_ahead)


def _compare(look_ahead: int) -> None:
    """The laws on depths that the program knows, beside the notes."""
    print(f"\n{NAMES[KNOWN]}; preview of {look_ahead} revolutions; in brackets: the notes\n")
    _head(
        "law",
        "preview",
        "peak %",
        "excess N·s",
        "without noise",
        "mean feed %",
        "settling, revs",
        "RMS %",
        "unstable of 15",
        "µs a step",
        "p99",
    )
    for has_preview in (False, True):
        for name in LAWS:
            _compare_one(name, replace(KNOWN, look_ahead=look_ahead if has_preview else 0))


def _compare_one(name: LawName, trial: Trial) -> None:
    """One law on one trial."""
    has_preview = trial.look_ahead > 0
    done, noted = run(name, trial), NOTED.get((name, has_preview))
    scored, cost = score(done), step_cost(name, trial)
    quiet = score(run(name, replace(trial, bench=PERFECT)))
    restless = len(unstable(name, trial))
    _row(
        name,
        "yes" if has_preview else "no",
        f"{100.0 * scored.peak:.1f}" + (f" ({noted.peak:g})" if noted else ""),
        f"{scored.excess:.1f}",
        f"{quiet.excess:.1f}",
        f"{100.0 * scored.feed:.1f}",
        _settling(done, scored) + (f" ({noted.settling})" if noted else ""),
        f"{100.0 * scored.rms:.1f}" + (f" ({noted.rms:g})" if noted else ""),
        f"{restless}" + (f" ({noted.unstable})" if noted else ""),
        f"{cost.cpu:.1f}" + (f" ({noted.step:g})" if noted else ""),
        f"{cost.cpu_p99:.0f}" + (f" ({noted.step_p99})" if noted and noted.step_p99 else ""),
    )


def _try(look_ahead: int) -> None:
    """Every law in every trial, without and with preview."""
    for trial, title in NAMES.items():
        if trial is KNOWN:
            continue
        print(f"\n{title}; without → with preview\n")
        _head(
            "law",
            "peak %",
            "excess N·s",
            "mean feed %",
            "settling, revs",
            "RMS %",
            "off at rest %",
        )
        for name in LAWS:
            runs = [run(name, replace(trial, look_ahead=each)) for each in (0, look_ahead)]
            scores = [score(each) for each in runs]
            _row(
                name,
                _both([f"{100.0 * each.peak:.1f}" for each in scores]),
                _both([f"{each.excess:.1f}" for each in scores]),
                _both([f"{100.0 * each.feed:.1f}" for each in scores]),
                _both([_settling(*each) for each in zip(runs, scores, strict=True)]),
                _both([f"{100.0 * each.rms:.1f}" for each in scores]),
                _both([f"{100.0 * max(settled(each), key=abs):+.1f}" for each in runs]),
            )


def _noise(look_ahead: int) -> None:
    """Effect of the instrument on a revolution's mean, and of that on the force."""
    print("\nStandard deviations of the mean of a revolution at rest, log-pi with preview\n")
    _head("trial", "measured over true %", "true %")
    for trial in (KNOWN, LOST):
        done = run(LawName.LOG_PI, replace(trial, look_ahead=look_ahead))
        true = done.force.mean(axis=1)
        off = np.concatenate([(done.measured / true - 1.0)[each] for each in quiet(done)])
        swing = np.concatenate([true[each] / true[each].mean() - 1.0 for each in quiet(done)])
        _row(NAMES[trial], f"{100.0 * np.nanstd(off):.1f}", f"{100.0 * swing.std():.1f}")


def _look_ahead() -> None:
    """Look-ahead that the default law needs, and MPC."""
    for name in (LawName.LOG_PI, LawName.MPC):
        print(f"\n{name}: nominal, then hidden factors {FACTORS} × lags {LAGS} revolutions\n")
        _head(
            "look-ahead",
            "peak %",
            "excess N·s",
            "mean feed %",
            "worst peak %",
            "worst excess",
            "mean feed %",
        )
        for look_ahead in (0, *LOOK_AHEADS):
            nominal = replace(KNOWN, look_ahead=look_ahead)
            one, all_ = score(run(name, nominal)), _varied(name, nominal)
            noted = NOTED_PEAKS.get(look_ahead)
            _row(
                f"{look_ahead}",
                f"{100.0 * one.peak:.1f}" + (f" ({noted})" if noted else ""),
                f"{one.excess:.1f}",
                f"{100.0 * one.feed:.1f}",
                f"{100.0 * max(each.peak for each in all_):.1f}",
                f"{max(each.excess for each in all_):.1f}",
                f"{100.0 * float(np.mean([each.feed for each in all_])):.1f}",
            )


def _varied(name: LawName, trial: Trial) -> list[Score]:
    """The trial with hidden factors and lags."""
    return [
        score(
            run(
                name,
                replace(
                    trial, hidden=HiddenTruth(force_factor=factor, servo_lag=lag * REVOLUTION)
                ),
            )
        )
        for factor in FACTORS
        for lag in LAGS
    ]


def _guard(look_ahead: int) -> None:
    """Effect of the guard in an unknown cut."""
    print(f"\nTrial (b): the law alone → with the guard's hold at {OVERLOAD:g} × set point\n")
    over = f"revs above {OVERLOAD:g} ×"
    _head("law", "preview", "peak %", "excess N·s", "mean feed %", over, "holds", "stopped")
    for has_preview in (False, True):
        for name in LAWS:
            trial = replace(UNKNOWN, look_ahead=look_ahead if has_preview else 0)
            runs = [run(name, trial), run(name, replace(trial, band=GUARDED))]
            scores = [score(each) for each in runs]
            _row(
                name,
                "yes" if has_preview else "no",
                _both([f"{100.0 * each.peak:.1f}" for each in scores]),
                _both([f"{each.excess:.1f}" for each in scores]),
                _both([f"{100.0 * each.feed:.1f}" for each in scores]),
                _both([f"{_overloaded(each)}" for each in runs]),
                f"{runs[1].holds}",
                "yes" if runs[1].is_stopped else "no",
            )


def _overloaded(done: Run) -> int:
    """Revolutions above the overload."""
    return int((done.force.mean(axis=1) > OVERLOAD * SET_POINT).sum())


def _settling(done: Run, scored: Score) -> str:
    """Revolutions, "–" where the force never settled: the override ends at its ceiling."""
    lengths = [each.stop - each.start for each in done.stretches]
    return "/".join(
        "–" if took >= length else f"{took}"
        for took, length in zip(scored.settling, lengths, strict=True)
    )


def _both(values: Sequence[str]) -> str:
    return " → ".join(values)


def _head(*titles: str) -> None:
    """Head of a table in Markdown."""
    _row(*titles)
    print("|" + "---|" * len(titles))


def _row(*cells: str) -> None:
    print(f"| {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
