"""Circles of references: instances that lead back to themselves."""

from collections.abc import Iterator, Mapping


def circles(edges: Mapping[int, tuple[int, ...]]) -> Iterator[tuple[int, int]]:
    """First and last instance of each circle; no recursion, for files may nest deeply."""
    done: set[int] = set()
    for root in edges:
        path: dict[int, Iterator[int]] = {}
        current = None if root in done else root
        while current is not None:
            pending = path.setdefault(current, iter(edges.get(current, ())))
            step = next((id for id in pending if id not in done), None)
            if step is None:
                path.pop(current)
                done.add(current)
                current = next(reversed(path), None)
            elif step in path:
                yield step, current
            else:
                current = step
