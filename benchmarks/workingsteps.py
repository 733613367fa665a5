"""10 000 workingsteps by the closed form against the same by a loop over the convex program.

Both give the integer optimum of the same random workingsteps; the program is compiled once, as
one would use it. It is timed on a sample, since all of them would take minutes.
"""

import argparse
import time
from random import Random

from benchmarks.problems import random_problem
from optimiser.errors import Infeasible
from optimiser.modes import Mode
from optimiser.solver import geometric_program as program
from optimiser.solver import workingstep
from optimiser.solver.problem import Problem

COUNT = 10_000
"""Workingsteps that are drawn."""


def main(arguments: list[str] | None = None) -> None:
    """Print seconds for each workingstep, and the ratio."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--workingsteps", type=int, default=COUNT)
    parser.add_argument("--sample", type=int, default=150, help="solved by cvxpy too")
    options = parser.parse_args(arguments)
    random = Random(2026)
    problems = [random_problem(random) for _ in range(options.workingsteps)]
    sample = problems[: options.sample]
    program.solve(next(filter(_is_feasible, problems)), Mode.TC)  # compiles
    exact = _seconds(problems, by_program=False)
    same = _seconds(sample, by_program=False) / len(sample)
    general = _seconds(sample, by_program=True) / len(sample)
    print(f"{'method':34}{'workingsteps':>14}{'seconds':>10}{'µs each':>12}")
    for name, count, each in (
        ("closed form", len(problems), exact / len(problems)),
        ("closed form, sample", len(sample), same),
        ("cvxpy loop, sample", len(sample), general),
    ):
        print(f"{name:34}{count:14}{count * each:10.3f}{each * 1e6:12.1f}")
    print(f"ratio on the same sample: {general / same:.0f}")


def microseconds_each() -> float:
    """CPU time of the closed form, µs a workingstep."""
    random = Random(2026)
    problems = [random_problem(random) for _ in range(COUNT)]
    return 1e6 * _seconds(problems, by_program=False) / COUNT


def _is_feasible(problem: Problem) -> bool:
    try:
        workingstep.solve(problem, Mode.TC)
    except Infeasible:
        return False
    return True


def _seconds(problems: list[Problem], *, by_program: bool) -> float:
    """CPU seconds for all problems."""
    solve = program.solve if by_program else workingstep.solve
    start = time.process_time()
    for problem in problems:
        try:
            solve(problem, Mode.TC)
        except Infeasible:
            continue
    return time.process_time() - start


if __name__ == "__main__":
    main()
