"""Runs of the papers as an MTConnect client sees them over HTTP, beside the simulation.

Starts ``stepnc agent`` and reads it with the client of ``stepnc record``: Fig. 8 of paper 000,
the items of Fig. 10 of paper 003, energy and time of four programs.
``python -m benchmarks.monitored [PICTURE]`` also draws Fig. 8.
"""

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from subprocess import PIPE, Popen
from tempfile import TemporaryDirectory
from urllib.request import urlopen
from xml.etree import ElementTree

import numpy as np
from matplotlib.figure import Figure
from pyarrow import parquet

from service.recording.request import RecordingRequest
from service.recording.run import record
from service.requests.runs import SimulationRequest
from service.simulation.run import RunFiles, simulate
from simulator.motion.segments import Floats

PARTS = Path(__file__).parents[1] / "examples" / "parts"
STEPNC = Path(sys.executable).with_name("stepnc")
POWERS = ("x_axis_wattage", "y_axis_wattage", "z_axis_wattage", "c_axis_wattage",
          "coolant_wattage", "load_wattage")  # fmt: skip
RUNS = (("paper000", "paper000"), ("paper003_case1", "paper003"),
        ("paper003_case2", "paper003"), ("bracket", "vmc15"))  # fmt: skip
PRINTED = {
    "Position": "y_axis_path_position_actual_sample",
    "Wattage": "y_axis_wattage_sample",
}
"""Ids of the y axis in Fig. 10 of paper 003."""


@contextmanager
def agent(part: str, machine: str, rate: int) -> Iterator[str]:
    """Address of an agent that has published a whole run."""
    words = [str(STEPNC), "agent", str(PARTS / f"{part}.stpnc"), "--machine", machine,
             "--rate", str(rate), "--speed", "0", "--port", "0", "--names", "papers",
             "--buffer", str(1 << 22)]  # fmt: skip
    process = Popen(words, stderr=PIPE, text=True)
    try:
        for line in process.stderr or ():
            if line.startswith("MTConnect agent: "):
                yield line.split()[-1].removesuffix("/current")
                break
    finally:
        process.terminate()
        process.communicate()


def recorded(part: str, machine: str, rate: int) -> tuple[dict[str, Floats], Floats]:
    """Columns of a run as a client has them, and the sum of its wattages in W."""
    whole = RecordingRequest(is_buffered=True, is_until_completed=True)
    with TemporaryDirectory() as folder, agent(part, machine, rate) as url:
        record(f"{url}/{machine}", file := Path(folder) / "run.parquet", whole)
        table = parquet.read_table(file)
    columns = {name: table[name].to_numpy() for name in ("time_s", *POWERS)
               if name in table.column_names}  # fmt: skip
    total = np.sum([columns[name] for name in POWERS if name in columns], axis=0)
    return columns, total


def figure_8(picture: Path | None) -> None:
    """The five events of paper 000."""
    run, total = recorded("paper000", "paper000", 100)
    time, spindle = run["time_s"], run["c_axis_wattage"]
    rises = np.flatnonzero(np.diff(total) > 1500.0) + 1
    entries = rises[time[rises] > 1.8]
    events = {
        "1 spindle starts": int(spindle[: entries[0]].argmax()),
        "2 coolant": int((run["coolant_wattage"] > 0.0).argmax()),
        "3 entry": int(entries[0]),
        "4 smaller diameter": int(entries[-1]),
        "5 spindle stops": int(np.flatnonzero(spindle > 0.0)[-1]) + 1,
    }
    print("Paper 000, Fig. 8: sum of the wattage items before and at each event, W")
    for text, at in events.items():
        print(
            f"  {text:20} {time[at]:6.2f} s  {total[max(at - 1, 0)]:6.0f} -> {total[at]:5.0f}"
        )
    if picture is not None:
        figure = Figure(figsize=(9.0, 4.5), layout="constrained")
        axes = figure.subplots()
        axes.step(time, total, where="post", label="total")
        axes.step(time, spindle, where="post", label="spindle", linewidth=1.0)
        axes.set(xlabel="time, s", ylabel="power, W")
        for text, at in events.items():
            axes.annotate(text.split()[0], (time[at], total[at]), xytext=(6, 10),
                          textcoords="offset points")  # fmt: skip
        axes.legend()
        picture.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(picture, dpi=100)
        print(f"  picture: {picture}")


def figure_10() -> None:
    """The items of paper 003, of the first moment at which the y axis is known."""
    path = "//Linear[@name='Y']//DataItem[@category='SAMPLE']"
    with agent("paper003_case2", "paper003", 10) as url:
        document = urlopen(f"{url}/sample?count=10000&from=1&path={path}").read()
    seen = [each for each in ElementTree.fromstring(document).iter() if each.get("sequence")]
    known = [each for each in seen if each.text != "UNAVAILABLE"]
    first = next(each for each in known if each.tag.endswith("Position"))
    print("Paper 003, Fig. 10: element, id, printed id, sequence, subtype, value")
    for each in known:
        name = each.tag.rpartition("}")[2]
        if name in PRINTED and each.get("timestamp") == first.get("timestamp"):
            print(f"  {name:9} {each.get('dataItemId'):23} {PRINTED[name]:35} "
                  f"{each.get('sequence')} {each.get('subType')} {each.text}")  # fmt: skip


def energies() -> None:
    """Energy and time that a client finds; each power holds until the next sample."""
    print("run             machine   rate Hz  energy kJ  simulated  ratio    time s  simulated")
    for part, machine in RUNS:
        files = RunFiles(file=PARTS / f"{part}.stpnc")
        whole = simulate(SimulationRequest(machine=machine), files).whole
        for rate in (10, 100):
            run, total = recorded(part, machine, rate)
            energy = float(np.nansum(total[:-1] * np.diff(run["time_s"])))
            print(
                f"{part:15} {machine:8} {rate:8d} {energy / 1000.0:10.1f} "
                f"{whole.energy.total / 1000.0:10.1f}  {energy / whole.energy.total:.5f} "
                f"{run['time_s'][-1]:8.1f} {whole.duration:10.1f}"
            )


def main(words: Sequence[str]) -> None:
    """Print all three."""
    figure_8(Path(words[0]) if words else None)
    figure_10()
    energies()


if __name__ == "__main__":
    main(sys.argv[1:])
