"""Plans beside their runs on the virtual machine, and the count of what differs.

Each part is planned in several materials and with several options, and run. Every figure of
every workingstep is compared: time, force, thrust, deflection, torque, power, volume at the
nominal k_c; bounds with the k_c at the quantile of the plan; and the stock that is left with
that of the program as given. Parts of the corpus are left out where it does not lie beside the
project.
"""

import argparse
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import chain
from pathlib import Path

from optimiser.modes import Free, Mode
from service.requests.advice import AdviceRequest
from service.requests.program_facts import Units
from service.simulation.confirmation import Confirmation, Figure
from service.verbs.optimise.program import advise_program as optimise
from service.verbs.optimise.request import AdviceFiles
from stepnc_model.errors import StepNcError

ROOT = Path(__file__).parents[1]
PARTS = ROOT / "examples" / "parts"
CORPUS = ROOT.parent / "shared" / "corpus" / "iso14649"

WITHIN = 0.05
"""Relative difference between plan and run that is counted."""

MATERIALS = ("c45", "42crmo4", "aisi304", "gg25", "al6061", "ti6al4v", "inconel718")
TURNED = (*MATERIALS, "hardened_55hrc", "hardened_60hrc")


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A part, and how it is planned."""

    file: Path
    request: AdviceRequest
    options: str = ""

    @property
    def name(self) -> str:
        """Part, material and options."""
        parts = (self.file.stem, self.request.machine, self.request.material, self.options)
        return " ".join(part for part in parts if part)


def cases() -> Iterator[Case]:
    """Every case; each bracket and shaft in all materials, and with options in one of them."""
    milled = AdviceRequest(machine="vmc15")
    bracket, shaft = PARTS / "bracket.stpnc", PARTS / "shaft.stpnc"
    for material in MATERIALS:
        yield Case(file=bracket, request=replace(milled, material=material))
    speed = replace(milled, free=(Free.FEED, Free.DEPTH, Free.SPEED))
    yield Case(file=bracket, request=speed, options="free speed")
    held = replace(milled, free=(Free.FEED,))
    yield Case(file=bracket, request=held, options="feed only")
    for mode in (Mode.QC, Mode.EC):
        yield Case(file=bracket, request=replace(milled, mode=mode), options=mode.value)
    turned = AdviceRequest(machine="lathe22")
    for material in TURNED:
        yield Case(file=shaft, request=replace(turned, material=material))
    speed = replace(turned, free=(Free.FEED, Free.DEPTH, Free.SPEED))
    yield Case(file=shaft, request=speed, options="free speed")
    pocket = PARTS / "paper003_pocket.stpnc"
    for machine in ("vmc15", "paper003"):
        yield Case(file=pocket, request=AdviceRequest(machine=machine))
    # The file draws no raw part.
    block = AdviceRequest(machine="vmc15", material="C45", stock="0,0,-30,100,120,5")
    yield Case(file=CORPUS / "ex1.stp", request=block)
    flanks = AdviceRequest(machine="vmc15", units=Units("rpm-mmtooth"))
    yield Case(file=CORPUS / "RanhuraPerfilVee.p21", request=flanks)


def main(arguments: list[str] | None = None) -> None:
    """Print a row for each workingstep of each case, and the counts."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--only", default="", metavar="WORDS", help="cases whose name has all these words"
    )
    parser.add_argument("--rows", action="store_true", help="print every workingstep")
    options = parser.parse_args(arguments)
    found = []
    for case in cases():
        if not set(options.only.split()) <= set(case.name.split()):
            continue
        if not case.file.exists():
            print(f"{case.file} is not there: left out")
            continue
        try:
            found.append(confirmed(case))
        except StepNcError as error:
            print(f"{case.name}: {error}")
            continue
        _print(case.name, found[-1], has_rows=options.rows)
    print(summary(found))


def confirmed(case: Case) -> Confirmation:
    """A plan beside its run; nothing is written."""
    files = AdviceFiles(file=case.file, dry_run=True)
    request = replace(case.request, is_confirmed=True, keep_going=True)
    found = optimise(request, files).confirmation
    if found is None:
        raise ValueError("a plan that is to be confirmed has its confirmation")
    return found


def summary(found: list[Confirmation]) -> str:
    """Counts over all cases: figures that differ, bounds passed, stock that differs."""
    steps = [step for each in found for step in each.steps]
    figures = [figure for step in steps for figure in step.figures]
    compared = [figure for figure in figures if is_compared(figure)]
    differ = sum(off(figure) > WITHIN for figure in compared)
    advised = [figure for step in steps if step.is_advised for figure in step.figures]
    bounds = sum(figure.is_passed for figure in advised)
    kept = sum(figure.is_passed for figure in figures) - bounds
    stock = sum(step.left is not None and step.left.is_seen for step in steps)
    unknown = sum(step.left is None for step in steps)
    return (
        f"{len(found)} plans, {len(steps)} workingsteps, {len(compared)} figures: {differ} "
        f"differ by more than {WITHIN:.0%}, {bounds} bounds passed at the quantile "
        f"({kept} more where no feed was advised); other stock is left by {stock} "
        f"workingsteps, not known of {unknown}"
    )


def is_compared(figure: Figure) -> bool:
    """True if plan or run have anything of a quantity."""
    return figure.promised > 0.0 or figure.simulated > 0.0


def off(figure: Figure) -> float:
    """Relative difference between plan and run."""
    return 1.0 if figure.ratio is None else abs(figure.ratio - 1.0)


def _print(name: str, confirmation: Confirmation, *, has_rows: bool) -> None:
    """One case: its rows if asked for, the figures that differ most, and what is passed."""
    print(name)
    if has_rows:
        headings = [figure.heading for figure in confirmation.steps[0].figures]
        print(f"  {'':24}" + "".join(f"{heading:>26}" for heading in headings))
        for step in confirmation.steps:
            row = "".join(f"{_told(figure):>26}" for figure in step.figures)
            print(f"  {step.id:24}{row}")
    columns = list(zip(*(step.figures for step in confirmation.steps), strict=True))
    worst = (max(filter(is_compared, column), key=off, default=None) for column in columns)
    parts = (f"{each.heading} {100.0 * off(each):.2f} %" for each in worst if each is not None)
    print(f"  farthest: {', '.join(parts)}")
    far = (
        f"{step.id}: {figure.heading} {_told(figure)}"
        for step in confirmation.steps
        for figure in step.figures
        if is_compared(figure) and off(figure) > WITHIN
    )
    for text in chain(far, confirmation.passed):
        print(f"  ! {text}")


def _told(figure: Figure) -> str:
    if figure.ratio is None:
        return "" if figure.simulated == 0.0 else f"0 -> {figure.simulated:.4g}"
    return f"{figure.promised:.4g} -> {figure.simulated:.4g} ({figure.ratio:.3f})"


if __name__ == "__main__":
    main()
