"""Circles of references."""

from stepnc_model.programs.binding import circles
from tests.every_case import every_case


@every_case(
    ("edges", "found"),
    [
        ({}, []),
        ({1: (2, 3), 2: (3,), 3: ()}, []),
        ({1: (1,)}, [(1, 1)]),
        ({1: (2,), 2: (3,), 3: (1,)}, [(1, 3)]),
        ({1: (2,), 2: (1,), 3: (4,), 4: (3,)}, [(1, 2), (3, 4)]),
        ({1: (9,)}, []),
    ],
)
def test_a_circle_is_told_by_its_first_and_last_instance(
    edges: dict[int, tuple[int, ...]], found: list[tuple[int, int]]
) -> None:
    assert list(circles(edges)) == found


def test_a_long_chain_is_no_recursion() -> None:
    edges = {n: (n + 1,) for n in range(10_000)}
    assert list(circles(edges)) == []
    assert list(circles({**edges, 10_000: (0,)})) == [(0, 10_000)]
