"""Learned models of the total power of 800 parts, as § 4.3 of Lechevalier et al. (2015).

The paper's part, machine and network are not printed: here a pocket is cut on the mill of their
later paper, within the ranges of Table 1. 500 rows train, the next 300 test.
``python examples/08_paper001_learned.py [FOLDER]``; rows in the folder are made once.
"""

import sys
from pathlib import Path

import stepnc
from extras.learning.dataset_run import make_dataset
from extras.learning.models import ModelKind

PARTS = Path(__file__).resolve().parent / "parts"
DESIGN = f"""program = "{PARTS / "paper003_pocket.stpnc"}"
machine = "paper003"
feed_mm_s = [30, 90]
spindle_rad_s = [75.4, 226.2]
depth_mm = [2.5, 3.5]
seed = 1
deviation = true
"""


def main(folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    design = folder / "design.toml"
    design.write_text(DESIGN, encoding="utf-8")
    data = folder / "rows"
    make_dataset(design, data, rows=800, tell=lambda text: print(text, file=sys.stderr))
    for target in ("total_power_w", "total_power_exact_w"):
        print(f"{target:20}      R2  (95 %)              MAE W  RMSE W  MAPE %")
        shown = set()
        for kind in ModelKind:
            result = stepnc.learn(data, target=target, model=kind.value)
            for each in result.scored:
                if each.name in shown:
                    continue
                shown.add(each.name)
                scores = each.scores
                r2, mae, rmse = scores.r2, scores.mae.value, scores.rmse.value
                print(
                    f"{each.name:20} {r2.value:8.5f}  ({r2.low:.5f} to {r2.high:.5f})"
                    f"  {mae:6.2f}  {rmse:6.2f}  {scores.mape.value:6.3f}"
                )


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path("build/paper001"))
