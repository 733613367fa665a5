"""Runs in LinuxCNC's namespaces, under the system's Python: starts it, runs programs, ends it.

``session.py ORDER`` reads a JSON order, and prints a line of JSON for each program that ended.
It is the first process of its namespaces, so that all others, and their shared memory, end with
it, however it ends. It ends itself when its standard input closes, that is with its owner.

``linuxcnc``, the script, is not used: it needs Tcl, a lock in /tmp and a display. Nothing else
of the project is imported: the modules of LinuxCNC belong to the system's Python alone.
"""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

POLL = 0.002
"""Interval at which the state of LinuxCNC is read, s."""


def main() -> None:
    """Run the order that is named on the command line."""
    order = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    threading.Thread(target=_obey_owner, daemon=True).start()
    folder = Path(order["folder"])
    os.environ.update(
        INI_FILE_NAME=str(folder / "machine.ini"),
        HOME=str(folder),
        RTAPI_FIFO_PATH=str(folder / "fifo"),
        PATH="/usr/sbin:/usr/bin:/sbin:/bin",
    )
    os.chdir(folder)
    _start(order)
    control = _Control(order["patience_s"])
    if order["loop"]:
        _tell({"ready": True})
    for program in order["programs"]:
        _tell(control.run(**program))
    if order["loop"]:
        # Its owner still looks at pins, and ends it.
        threading.Event().wait()
    os._exit(0)


def _tell(found: dict[str, Any]) -> None:
    """Write a line of JSON to the owner."""
    sys.stdout.write(json.dumps(found) + "\n")
    sys.stdout.flush()


def _obey_owner() -> None:
    """Do what an operator would do, line by line; end everything with the owner."""
    for line in sys.stdin:
        _tell({"answer": _obeyed(*json.loads(line))})
    os._exit(1)


def _obeyed(order: str, *words: Any) -> str:
    """Obey an order: a command of HAL or of the task, or the end of the component."""
    if order == "halcmd":
        told = subprocess.run(["halcmd", *words], capture_output=True, text=True, check=False)
        return told.stdout.strip() or told.stderr.strip()
    if order == "kill":
        for place in Path("/proc").glob("[0-9]*/cmdline"):
            if words[0].encode() in place.read_bytes():
                os.kill(int(place.parent.name), signal.SIGKILL)
        return ""
    import linuxcnc  # noqa: PLC0415 (as in _Control)

    command = linuxcnc.command()
    values = [getattr(linuxcnc, word) if isinstance(word, str) else word for word in words]
    getattr(command, order)(*values)
    return ""


def _start(order: dict[str, Any]) -> None:
    """Start the processes of LinuxCNC, in the order in which they wait for each other."""
    preload = {"LD_PRELOAD": order["preload"]} if order["preload"] else {}
    speed = {**os.environ, **preload, "SERVO_SPEEDUP": str(order["speedup"])}
    _call("linuxcncsvr", "-ini", "machine.ini")
    _call("halcmd", "loadusr", "-Wn", "iocontrol", "io", "-ini", "machine.ini")
    # The first command starts rtapi_app, which alone may run faster than the clock.
    _call("halcmd", "loadrt", "tpmod", environment=speed)
    _call("halcmd", "loadrt", "homemod")
    _call("halcmd", "-i", "machine.ini", "-f", "machine.hal")
    if order["loop"]:
        _call("halcmd", "-i", "machine.ini", "-f", "loop.hal")
    # Before milltask, which waits 20 s for a servo thread that does not run.
    _call("halcmd", "start")
    _call("halcmd", "loadusr", "-Wn", "inihal", "milltask", "-ini", "machine.ini")


def _call(*command: str, environment: dict[str, str] | None = None) -> None:
    """Run a command; what it prints goes to a file, for processes stay behind."""
    with Path("start.log").open("ab") as log:
        subprocess.run(command, check=True, stdout=log, stderr=log, env=environment)


class _Control:
    """LinuxCNC, switched on and homed."""

    def __init__(self, patience: float) -> None:
        sys.path.append("/usr/lib/python3/dist-packages")
        import linuxcnc  # noqa: PLC0415 (it looks for the INI file when it is loaded)

        self.api = linuxcnc
        self.command, self.stat = linuxcnc.command(), linuxcnc.stat()
        self.errors = linuxcnc.error_channel()
        self.patience = patience
        states = (linuxcnc.STATE_ESTOP, linuxcnc.STATE_ESTOP_RESET)
        self._until(lambda: self.stat.task_state in states, "a state")
        self._told(self.command.state, linuxcnc.STATE_ESTOP_RESET)
        self._told(self.command.state, linuxcnc.STATE_ON)
        self._until(lambda: self.stat.task_state == linuxcnc.STATE_ON, "the machine on")
        self._told(self.command.teleop_enable, 0)
        self.command.home(-1)
        self._until(lambda: all(self.stat.homed[: self.stat.joints]), "homed axes")
        # On by default: M1 would wait for ever.
        self._told(self.command.set_optional_stop, False)

    def run(
        self, *, file: str, samples: str, start: list[str], waits_for_loop: bool
    ) -> dict[str, Any]:
        """Run commands that lead to the start, then a program, and record its motion."""
        api = self.api
        self._told(self.command.mode, api.MODE_MDI)
        for line in start:
            self._told(self.command.mdi, line)
            self._until(self._is_idle, line)
        messages = self._messages()
        self._told(self.command.mode, api.MODE_AUTO)
        self._told(self.command.program_open, file)
        with Path(samples).open("wb") as rows:
            reader = subprocess.Popen(["halsampler", "-t"], stdout=rows)
        if waits_for_loop:
            # The operator of a shop waits for this, too.
            self._until(lambda: _bit("stepnc.armed"), "a loop that is armed")
        _call("halcmd", "setp", "sampler.0.enable", "1")
        overruns = _pin("sampler.0.overruns")
        self._told(self.command.auto, api.AUTO_RUN, 0)
        self._until(self._is_idle, "the end of the program")
        _call("halcmd", "setp", "sampler.0.enable", "0")
        self._until(lambda: _pin("sampler.0.curr-depth") == 0, "all samples")
        reader.terminate()
        reader.wait()
        messages += self._messages()
        return {"messages": messages, "lost": _pin("sampler.0.overruns") - overruns}

    def _told(self, order: Callable[..., Any], *values: Any) -> None:
        """Give a command, and wait until it has been taken."""
        order(*values)
        serial = self.command.serial
        self._until(lambda: self.stat.echo_serial_number - serial >= 0, order.__name__)

    def _is_idle(self) -> bool:
        """True if the interpreter has ended and the axes stand."""
        stat, api = self.stat, self.api
        is_read = stat.interp_state == api.INTERP_IDLE and stat.exec_state == api.EXEC_DONE
        return bool(is_read and stat.inpos and stat.queue == 0)

    def _messages(self) -> list[str]:
        """Messages to the operator since the last call."""
        found = []
        while message := self.errors.poll():
            found.append(str(message[1]).strip())
        return found

    def _until(self, is_true: Callable[[], bool], what: str) -> None:
        """Poll the state until something is true."""
        end = time.monotonic() + self.patience
        while time.monotonic() < end:
            try:
                self.stat.poll()
            except self.api.error:
                pass  # milltask has not written its first state yet
            else:
                if is_true():
                    return
            time.sleep(POLL)
        _tell({"failed": f"{what}: not within {self.patience:g} s"})
        os._exit(1)


def _bit(name: str) -> bool:
    """Value of a pin that is true or false."""
    told = subprocess.run(["halcmd", "getp", name], check=True, capture_output=True, text=True)
    return told.stdout.strip() == "TRUE"


def _pin(name: str) -> int:
    """Value of a pin that counts."""
    told = subprocess.run(["halcmd", "getp", name], check=True, capture_output=True, text=True)
    return int(told.stdout)


if __name__ == "__main__":
    main()
