"""Faults of the closed loop on a real LinuxCNC: what its motion does, and what the loop says.

Each fault happens in a cut on a LinuxCNC without a machine, in real time. The end is read from
the control's own pins, not from the loop.
"""

import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory

import stepnc
from extras.linuxcnc.bench import LoopBench, bench_with_loop
from extras.linuxcnc.configuration import SAFE
from simulator.library import load_machine

PART = Path(__file__).parents[1] / "examples" / "parts" / "paper002.stpnc"
PROGRAMMED = 123.787 / 60.0
"""Programmed feed of the part, mm/s."""
PATIENCE = 120.0
"""Longest time until a cut begins or a fault has its end, s."""
LIMIT = 600.0
"""Hard limit of the load, N; the cut has 190 N."""
PIN = "measured-load"
"""Signal of the load, where it does not come from the model."""
SLOW = 1.02 * SAFE
"""Feed that counts as the safe one, as a share of the programmed feed."""

Act = Callable[[LoopBench, "subprocess.Popen[str]"], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One fault, and the end that it must have."""

    name: str
    act: Act
    bound: float = 0.0
    """Greatest feed in the end, as a share of the programmed feed."""
    is_measured: bool = False
    """Whether the load comes from a pin, in N."""
    load: float | None = None
    """Load from then on, N, where it stays alive."""
    words: str = ""
    """Words of the event that the loop must tell; empty: it cannot tell any."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ended:
    """End of a fault."""

    fault: Fault
    feed: float
    """Feed in the end, as a share of the programmed feed."""
    seconds: float
    """Longest time from the fault until the feed was within its bound for good, s."""
    event: str
    """Last event that the loop told."""

    @property
    def is_safe(self) -> bool:
        """True if the feed came within its bound, and the loop told why if it could."""
        return self.feed <= self.fault.bound and self.fault.words in self.event


def _halcmd(*words: str) -> Act:
    return lambda bench, _: _order(bench, "halcmd", *words)


def _task(*words: str | float) -> Act:
    return lambda bench, _: _order(bench, *words)


def _order(bench: LoopBench, *words: str | float) -> None:
    bench.order(*words)


def _killed(_: LoopBench, loop: "subprocess.Popen[str]") -> None:
    loop.kill()


def _stopped(_: LoopBench, loop: "subprocess.Popen[str]") -> None:
    loop.terminate()


FAULTS = (
    Fault(name="loop killed (-9), and its socket cut", act=_killed, bound=SLOW),
    Fault(name="loop stopped (SIGTERM)", act=_stopped),
    Fault(name="component killed (-9)", act=_task("kill", "component.py"), bound=SLOW,
          words="has not answered"),
    Fault(name="E-stop", act=_task("state", "STATE_ESTOP"), words="emergency stop"),
    Fault(name="operator pauses the program", act=_task("auto", "AUTO_PAUSE"),
          words="override"),
    Fault(name="operator's override to 80 %", act=_task("feedrate", 0.8),
          words="override is 80 %"),
    Fault(name="watchdog switched off", act=_halcmd("setp", "watchdog.timeout-0", "0.0001"),
          bound=SLOW, words="watchdog"),
    Fault(name="load above the hard limit", is_measured=True,
          act=_halcmd("sets", PIN, "900"), words="hard load limit"),
    Fault(name="load no number (NaN)", is_measured=True, act=_halcmd("sets", PIN, "nan"),
          words="hard load limit"),
    Fault(name="load frozen", is_measured=True, act=_halcmd("sets", PIN, "190"), bound=0.55,
          words="force"),
    Fault(name="sign of the load inverted", is_measured=True,
          act=_halcmd("sets", PIN, "-190"), load=-190.0, bound=0.55, words="force"),
)  # fmt: skip
"""Faults in a cut."""


def short_program(folder: Path) -> Path:
    """Post the part's first 40 mm, with adaptive feed, so that a run takes half a minute."""
    code = folder / "short.ngc"
    stepnc.post(str(PART), control="linuxcnc", adaptive_feed=True, output=str(code))
    text = code.read_text("ascii").replace("Y311", "Y40")
    # The approach in air is shorter, too.
    code.write_text(text.replace("Z13", "Z4", 1), "ascii")
    return code


def ends(faults: tuple[Fault, ...] = FAULTS) -> Iterator[Ended]:
    """Run faults one after another, each on a LinuxCNC of its own."""
    with TemporaryDirectory() as name:
        code = short_program(Path(name))
        for fault in faults:
            yield ended(fault, code)


def ended(fault: Fault, code: Path) -> Ended:
    """Run one fault to its end."""
    machine = load_machine("vmc15")
    bench_of = bench_with_loop(machine, code, start=(0.0, 0.0, 30.0), load_limit=LIMIT)
    with bench_of as bench:
        load = ["--virtual-load"]
        if fault.is_measured:
            for words in (
                ("newsig", PIN, "float"), ("sets", PIN, "1"),
                ("unlinkp", "stepnc-limit.in1"), ("net", PIN, "stepnc-limit.in1"),
            ):  # fmt: skip
                bench.order("halcmd", *words)
            load = ["--load-pin", PIN, "--load-unit", "N"]
        options = ["--nc", str(code), "--machine", "vmc15", "--linuxcnc", str(bench.socket)]
        command = [sys.executable, "-c", COMMAND, "control", str(PART), *options, *load]
        loop = subprocess.Popen(
            command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        try:
            return _observed(fault, bench, loop)
        finally:
            loop.kill()
            loop.wait()


def _observed(fault: Fault, bench: LoopBench, loop: "subprocess.Popen[str]") -> Ended:
    _until(lambda: _cuts(bench, fault), loop)
    begin = time.monotonic()
    fault.act(bench, loop)
    within: float | None = None
    for row in count():
        if fault.load is not None:
            _set_load(bench, fault.load, row)
        feed = _feed(bench)
        # After the poll, so that no time is left out.
        passed = time.monotonic() - begin
        if feed > fault.bound:
            within = None
        elif within is None:
            within = passed
        if passed > SETTLED:
            break
    loop.terminate()
    told = loop.communicate()[0]
    events = [
        line.split("s  ", 1)[1]
        for line in told.splitlines()
        if re.match(r"\s*[0-9.]+ s  \S", line)
    ]
    return Ended(
        fault=fault,
        feed=feed,
        seconds=inf if within is None else within,
        event=events[-1] if events else told.strip()[-200:],
    )


COMMAND = "from service.cli.main import main; main()"
CONTACT = -6.0
"""Place from which the load is that of a cut, mm along y."""
FORCE = 190.0
"""Load in the cut, N."""
CUT = 2.0
"""Place from which the tool cuts with half of its width, mm along y."""
FEED = 2
"""Kind of motion of a straight feed."""
SETTLED = 8.0
"""Time after which a fault has its end, s: the bench's watchdog takes 5 s."""


def _cuts(bench: LoopBench, fault: Fault) -> bool:
    """True once the tool is in the part, at feed; a measured load is that of the place."""
    place = _pin(bench, "axis.y.pos-cmd")
    if fault.is_measured:
        _set_load(bench, FORCE if place > CONTACT else 0.0, round(100.0 * place))
    return _pin(bench, "motion.motion-type") == FEED and place > CUT


def _set_load(bench: LoopBench, load: float, row: int) -> None:
    """Set the load with some noise, as a live one has."""
    bench.order("halcmd", "sets", PIN, f"{load + 0.1 * (row % 7):g}")


def _feed(bench: LoopBench) -> float:
    return _pin(bench, "motion.current-vel") / PROGRAMMED


def _pin(bench: LoopBench, name: str) -> float:
    return float(bench.order("halcmd", "getp", name))


def _until(is_true: Callable[[], bool], loop: "subprocess.Popen[str]") -> None:
    end = time.monotonic() + PATIENCE
    while loop.poll() is not None or not is_true():
        if time.monotonic() > end or loop.poll() is not None:
            loop.kill()
            said = loop.communicate()[0]
            raise RuntimeError(f"the cut did not begin: {said.strip()[-500:]}")


def print_ends() -> int:
    """Print a table of all faults; 1 if one is not safe."""
    found = []
    print("| fault in the cut | feed in the end | within it after | the loop says |")
    print("|---|---|---|---|")
    for each in ends():
        # A loop that was killed says nothing.
        event = each.event.replace("|", "/") if each.fault.words else "–"
        print(
            f"| {each.fault.name} | {each.feed:.0%} | {each.seconds:.1f} s | {event} |",
            flush=True,
        )
        found.append(each)
    wrong = [each.fault.name for each in found if not each.is_safe]
    for name in wrong:
        print(f"not safe: {name}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(print_ends())
