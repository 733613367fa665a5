"""``optimise`` on the sample bracket as a whole process, beside importing numpy and lxml.

The two run in turn, so that a machine that slows down slows both; ratios are pair by pair.
"""

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

BRACKET = Path(__file__).parents[1] / "examples" / "parts" / "bracket.stpnc"


def main(arguments: list[str] | None = None) -> None:
    """Print the median wall seconds of both, and the median ratio."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=11)
    options = parser.parse_args(arguments)
    command = Path(sys.executable).with_name("optimise")
    with tempfile.TemporaryDirectory() as folder:
        ours = [str(command), str(BRACKET), "-o", str(Path(folder) / "bracket.stpnc")]
        peer = [sys.executable, "-c", "import numpy, lxml.etree"]
        _seconds(ours), _seconds(peer)  # warm the disk and the bytecode
        pairs = [(_seconds(ours), _seconds(peer)) for _ in range(options.runs)]
    print(f"{'process':34}{'median s':>10}")
    print(f"{'optimise bracket.stpnc':34}{median(one for one, _ in pairs):10.3f}")
    print(f"{'import numpy, lxml.etree':34}{median(two for _, two in pairs):10.3f}")
    print(f"ratio, median of {len(pairs)} pairs: {median(one / two for one, two in pairs):.2f}")


def _seconds(command: list[str]) -> float:
    """Wall seconds of one run."""
    start = time.perf_counter()
    subprocess.run(command, check=True, capture_output=True)
    return time.perf_counter() - start


if __name__ == "__main__":
    main()
