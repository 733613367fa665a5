"""Cost, time and edge lives of the sample parts, planned for TC, QC, EC and CC.

Machine rates and prices of edges are those of the machine files; speeds are free.
"""

from pathlib import Path

from optimiser.modes import Free, Mode
from service.requests.advice import AdviceRequest
from service.verbs.optimise.program import advise_program
from service.verbs.optimise.request import AdviceFiles

PARTS = Path(__file__).parents[1] / "examples" / "parts"
CASES = (("bracket", "vmc15"), ("shaft", "lathe22"))


def main() -> None:
    """Print one row for each part and mode, with the lives used by tool."""
    print(f"{'part':<9}{'mode':<5}{'cost':>8}{'time s':>9}{'energy kJ':>11}  edge lives used")
    for part, machine in CASES:
        for mode in Mode:
            plan = advise_program(
                AdviceRequest(mode=mode, machine=machine, material="c45", free=tuple(Free)),
                AdviceFiles(file=PARTS / f"{part}.stpnc", dry_run=True),
            ).plan
            shown = [(each.tool.id, each.after or each.before) for each in plan.advices]
            used: dict[str, float] = {}
            for tool, state in shown:
                if state is not None and state.lives is not None:
                    used[tool] = used.get(tool, 0.0) + state.lives
            money = sum(state.money or 0.0 for _, state in shown if state is not None)
            lives = ", ".join(f"{tool} {share:.2g}" for tool, share in used.items())
            print(
                f"{part:<9}{mode.value:<5}{money:>8.3f}{plan.time_after:>9.1f}"
                f"{plan.energy_after / 1e3:>11.1f}  {lives}"
            )


if __name__ == "__main__":
    main()
