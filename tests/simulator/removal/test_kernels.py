"""Compilers of the kernels."""

from simulator.removal.kernels import entry, inlined, kernel


def test_compilers_keep_the_function() -> None:
    def twice(value: float) -> float:
        return 2.0 * value

    for compiler in (entry, inlined, kernel):
        assert compiler(twice).py_func is twice  # type: ignore[attr-defined]
