"""Promised figures beside those that the virtual machine finds, and the worst ratio of each.

The bracket, the shaft, and example 1 of ISO 14649-11 where it lies beside the project; its file
draws no raw part, so that a block of 100 × 120 mm from 30 mm under to 5 mm above zero is taken.
"""

import argparse
from dataclasses import replace
from pathlib import Path

from service.confirmation import Confirmation, Figure
from service.requests.advice import AdviceRequest
from service.usecases import AdviceFiles, optimise

ROOT = Path(__file__).parents[1]
EX1 = ROOT.parent / "shared" / "corpus" / "iso14649" / "ex1.stp"

PARTS = (
    (ROOT / "examples" / "parts" / "bracket.stpnc", AdviceRequest(machine="vmc15")),
    (ROOT / "examples" / "parts" / "shaft.stpnc", AdviceRequest(machine="lathe22")),
    (EX1, AdviceRequest(machine="vmc15", material="C45", stock="0,0,-30,100,120,5")),
)


def main(arguments: list[str] | None = None) -> None:
    """Print a row for each workingstep of each part."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.parse_args(arguments)
    for file, request in PARTS:
        if file.exists():
            _print(file.name, confirmed(file, request))
        else:
            print(f"{file} is not there: left out")


def confirmed(file: Path, request: AdviceRequest) -> Confirmation:
    """A plan beside its run; nothing is written."""
    files = AdviceFiles(file=file, dry_run=True)
    found = optimise(replace(request, is_confirmed=True), files).confirmation
    if found is None:
        raise ValueError("a plan that is to be confirmed has its confirmation")
    return found


def _print(name: str, confirmation: Confirmation) -> None:
    """One part, and the ratios that are farthest from 1."""
    headings = [figure.heading for figure in confirmation.steps[0].figures]
    print(f"{name:24}" + "".join(f"{heading:>26}" for heading in headings))
    for step in confirmation.steps:
        print(f"{step.id:24}" + "".join(f"{_told(figure):>26}" for figure in step.figures))
    columns = zip(*(step.figures for step in confirmation.steps), strict=True)
    worst = [max((_off(figure) for figure in column), default=1.0) for column in columns]
    print(f"{'farthest from 1 by':24}" + "".join(f"{100.0 * off:24.2f} %" for off in worst))


def _told(figure: Figure) -> str:
    if figure.ratio is None:
        return ""
    return f"{figure.promised:.4g} -> {figure.found:.4g} ({figure.ratio:.3f})"


def _off(figure: Figure) -> float:
    return 0.0 if figure.ratio is None else abs(figure.ratio - 1.0)


if __name__ == "__main__":
    main()
