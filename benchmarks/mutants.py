"""Mutation testing of lines that are drawn: tests should notice each fault.

``python -m benchmarks.mutants --seed 1 --count 10`` draws lines of functions of the product,
makes one small fault in each (:mod:`benchmarks.faults`), and runs tests in a temporary clone of
HEAD until one fails, in rings: 1. the module of tests that mirrors the changed one and those
that import it, 2. those that reach it through other imports, nearest first, 3. all other quick
tests, 4. the slow ones. In ring 1 only the mirror may be slow. Tests in ``tests/tree``
read the sources without running them, and are left out.

A test counts if it fails twice with the fault and passes without. A run in which no test ends
for some minutes is given up, and counts if the same tests end without the fault. A fault with
which the module cannot be imported is passed over. Rows go to stdout, progress to stderr; exit
code 1: one was not found.
"""

import argparse
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from time import monotonic

from benchmarks.faults import Mutant, mutants
from benchmarks.house import PRODUCT, ROOT
from benchmarks.rings import QUICK, Stage, imports, stages

QUIET, SLOW_QUIET = 120.0, 600.0
"""s without output after which quick tests and others are given up where nothing else runs"""

PATIENCE = 10.0
"""s in which interrupted tests stop what they started"""

MOST_MEMORY = 8 << 30
"""bytes of a process: a loop that a fault made endless must not fill the machine"""

KERNELS = Path("simulator", "kernels", "__pycache__")

COMPILE = ("bracket.stpnc --machine vmc15 --lag", "shaft.stpnc --machine lathe22")
"""simulations that compile most kernels, as before ``make test``"""

FAILURE = re.compile(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", re.MULTILINE)

NO_FAILURE = {0, 5}
"""exit codes of pytest: all passed, none selected"""

TIMEOUT = "timeout"


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """Test that found a fault, and its ring; 0 if none did."""

    ring: int = 0
    found_by: str = "NOT FOUND"


@dataclass(frozen=True, slots=True, kw_only=True)
class Clone:
    """A copy of what is committed, in which faults are made."""

    folder: Path
    unsound: set[str] = field(default_factory=set)
    """tests that failed without a fault"""

    @contextmanager
    def mutated(self, mutant: Mutant, number: int) -> Iterator[None]:
        """Make a fault and take it back."""
        path = self.folder / mutant.path
        time = path.stat().st_mtime
        path.write_bytes(mutant.after)
        # Python takes bytecode for that of a text by its size and the second of its change.
        os.utime(path, (time, time + number))
        try:
            yield
        finally:
            path.write_bytes(mutant.before)
            os.utime(path, (time, time))

    def run(self, *command: str, quiet: float = SLOW_QUIET) -> tuple[int | None, str]:
        """Exit code of a Python command and what it printed; no code if it was given up."""
        log = self.folder.parent / "log"
        with log.open("wb") as output:
            process = subprocess.Popen(
                [self.folder / ".venv" / "bin" / "python", *command],
                cwd=self.folder, env=os.environ | {"PYTHONPATH": str(self.folder), "CI": "1"},
                stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                start_new_session=True,
            )  # fmt: skip
        try:
            code = _exit_code(process, log, quiet)
        finally:
            _stop(process)
        return code, log.read_text("utf-8", errors="replace")

    def failure(self, stage: Stage, without: Iterable[str] = ()) -> str:
        """First test of a stage that fails, or what else went wrong; empty if nothing did."""
        options = ["-m", stage.marker, *(f"--deselect={each}" for each in without)]
        options += ["-n", "auto"] if stage.ring > 2 else []
        code, text = self.run(
            *("-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *options, *stage.files),
            quiet=QUIET if stage.marker == QUICK else SLOW_QUIET,
        )
        if code in NO_FAILURE:
            return ""
        found = FAILURE.search(text)
        return found[1] if found else f"exit code {code} of pytest" if code else TIMEOUT

    def verdict(self, mutant: Mutant, number: int, todo: Iterable[Stage]) -> Verdict:
        """Run tests until one notices a fault."""
        passing: set[str] = set()
        for stage in todo:
            _say(f"mutant {number}, ring {stage.ring}: {len(stage.files)} files")
            while True:
                known = self.unsound | passing
                with self.mutated(mutant, number):
                    failed = self.failure(stage, known)
                    if not failed or failed in known:
                        break
                    one = replace(stage, ring=1, files=(failed,)) if "::" in failed else stage
                    # The first run may only have shown that a changed kernel was compiled.
                    is_repeated = failed == TIMEOUT or bool(self.failure(one))
                if not is_repeated:
                    passing.add(failed)
                elif self.failure(one):
                    (self.unsound if "::" in failed else passing).add(failed)
                    _say(f"fails without a fault: {failed}")
                else:
                    return Verdict(ring=stage.ring, found_by=failed)
        return Verdict()


def _exit_code(process: subprocess.Popen[bytes], log: Path, quiet: float) -> int | None:
    size = -1
    # Whoever else uses the machine makes tests slower, and compiling most of all.
    quiet *= max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))
    while size < (size := log.stat().st_size):
        with suppress(subprocess.TimeoutExpired):
            return process.wait(quiet)
    return None


def _stop(process: subprocess.Popen[bytes]) -> None:
    """End a process and what it left behind."""
    try:
        if process.poll() is None:
            with suppress(subprocess.TimeoutExpired):
                os.killpg(process.pid, signal.SIGINT)
                process.wait(PATIENCE)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()


def make_clone(folder: Path) -> Clone:
    """Clone HEAD as ``make shuffled`` does."""
    clone = Clone(folder=folder / "clone")
    subprocess.run(["git", "clone", "--quiet", ROOT, clone.folder], check=True)
    (clone.folder / ".venv").symlink_to(sys.prefix)
    if (shared := ROOT.parent / "shared").is_dir():
        (folder / "shared").symlink_to(shared.resolve())
    return clone


def compile_kernels(clone: Clone) -> None:
    """Take over compiled kernels and compile others.

    Their files are named by a digest of the bytecode (:mod:`simulator.kernels.store`): one
    with a fault finds none and is compiled.
    """
    (clone.folder / KERNELS).mkdir(exist_ok=True)
    for path in (ROOT / KERNELS).glob("*.o"):
        shutil.copy2(path, clone.folder / KERNELS)
    for each in COMPILE:
        clone.run(".venv/bin/stepnc", "simulate", *f"examples/parts/{each}".split())


def run(clone: Clone, drawn: Iterable[tuple[int, Mutant]], *, count: int, rings: int) -> int:
    """Print a row for each mutant and return the number of those that nothing found."""
    graph = imports(clone.folder)
    done = found = 0
    for number, mutant in drawn:
        name = mutant.path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
        with clone.mutated(mutant, number):
            code, _ = clone.run("-c", f"import {name}", quiet=QUIET)
        if code:
            _say(f"mutant {number} cannot be imported: passed over")
            continue
        begin = monotonic()
        todo = (each for each in stages(graph, mutant.path) if each.ring <= rings)
        verdict = clone.verdict(mutant, number, todo)
        ring = f"ring {verdict.ring}: " if verdict.ring else ""
        seconds = f"{monotonic() - begin:.0f} s"
        print(row(mutant, number), f"{ring}{verdict.found_by}", seconds, sep=" | ", flush=True)
        done, found = done + 1, found + bool(verdict.ring)
        if done == count:
            break
    print(f"{found} found / {done} drawn")
    return done - found


def row(mutant: Mutant, number: int) -> str:
    """Place of a fault, and its line before and after."""
    return " | ".join((str(number), f"{mutant.path}:{mutant.line}", *mutant.lines()))


@contextmanager
def _tidy() -> Iterator[None]:
    """Let no further signal interrupt the removal of the clone."""
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def main(arguments: list[str] | None = None) -> int:
    """Draw mutants, and print what finds them."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--rings", type=int, default=4, choices=range(1, 5))
    parser.add_argument("--places", action="store_true", help="only print what is drawn")
    parser.add_argument("--only", type=int, metavar="N", help="only the Nth that is drawn")
    options = parser.parse_args(arguments)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_MEMORY, most))
    with TemporaryDirectory(prefix="mutants-") as folder, suppress(KeyboardInterrupt), _tidy():
        clone = make_clone(Path(folder))
        sources = {
            str(path.relative_to(clone.folder)): path.read_bytes()
            for package in PRODUCT
            for path in (clone.folder / package).rglob("*.py")
        }
        drawn = enumerate(mutants(sources, Random(options.seed)), 1)
        chosen = islice(drawn, (options.only or 1) - 1, options.only)
        if options.places:
            for number, mutant in islice(chosen, options.count):
                print(row(mutant, number))
            return 0
        compile_kernels(clone)
        return min(1, run(clone, chosen, count=options.count, rings=options.rings))
    return 130


if __name__ == "__main__":
    sys.exit(main())
