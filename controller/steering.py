"""The law at work: tuned for the cut that begins, told of each revolution what it may know.

Running state. Units mm, s, N, rev/s.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from controller.aims import Aims
from controller.guard import Keeping
from controller.law import Law, Plant, Situation
from controller.preview import Expected, Preview
from controller.signal import Revolution
from simulator.reading import Reading

LEAST_WAY = 0.1
"""override at least with which the way of the next revolutions is reckoned"""


class Steering:
    """A law, and its state while there are chips. Running state.

    Parameters
    ----------
    law : callable
        A law tuned for a process.
    preview : Preview
        What the program expects, in equivalent forces.
    """

    def __init__(self, law: Callable[[Plant], Law[Any]], preview: Preview) -> None:
        self.preview = preview
        self._law_for = law
        self._laws: dict[Plant, Law[Any]] = {}
        self._cut: tuple[Law[Any], Any] | None = None

    def leave(self) -> None:
        """The cut is over: what the law remembers of it does not hold in the next one."""
        self._cut = None

    def wish(
        self, revolution: Revolution, keep: Keeping, *, aims: Aims, override: float
    ) -> float:
        """The override that the law wants after a revolution with chips.

        Parameters
        ----------
        revolution : Revolution
        keep : Keeping
            With a finite set point.
        aims : Aims
        override : float
            That was commanded last.
        """
        law, state = self._cut or self._entered(revolution, keep, aims, override)
        situation = self._situation(revolution, keep, aims=aims, override=override)
        state, wanted = law.decide(state, situation)
        self._cut = law, state
        return wanted

    def is_air(self, reading: Reading) -> bool:
        """Whether the program expects no chips where a reading was taken, nor near."""
        return self.preview.is_air(reading.progress, revolution=_way(reading))

    def weight(self, reading: Reading) -> float:
        """Equivalent over real force, for a reading: mean over the revolution that it ends."""
        if self.preview.weight is None:
            return 1.0
        way = _way(reading)
        return self.preview.weight_between(reading.progress - way, reading.progress)

    def expectation(self, revolution: Revolution, exponent: float) -> float:
        """Force that the catalogue's k_c gives at the override that was run, N."""
        mean = self.preview.mean(revolution.progress_before, revolution.progress)
        return float(mean * max(revolution.override, 0.0) ** exponent)

    def teeth(self, revolution: Revolution) -> Expected | None:
        """What equal teeth would take in each period of a revolution; None: not known."""
        return self.preview.expected(
            revolution.progress_before,
            revolution.progress,
            teeth=revolution.teeth,
            first=revolution.first,
        )

    def land_share(self, revolution: Revolution, expected: float) -> float:
        """What 1 mm of flank wear adds to measured over expected force, 1/mm; 0: not known."""
        if not expected > 0.0:
            return 0.0
        land = self.preview.mean_land(revolution.progress_before, revolution.progress)
        return land / expected

    def _entered(
        self, revolution: Revolution, keep: Keeping, aims: Aims, override: float
    ) -> tuple[Law[Any], Any]:
        """The law, tuned for what begins, and its state."""
        # Rounded, so that equal cuts find their law again.
        lag = round(max(aims.servo_lag * revolution.spindle_speed, 0.1), 1)
        plant = Plant(exponent=round(keep.exponent, 2) or keep.exponent, lag=lag)
        if plant not in self._laws:
            self._laws[plant] = self._law_for(plant)
        law = self._laws[plant]
        return law, law.begin(max(override, LEAST_WAY))

    def _situation(
        self, revolution: Revolution, keep: Keeping, *, aims: Aims, override: float
    ) -> Situation:
        known = Situation(
            force=revolution.force,
            set_point=keep.set_point,
            override=override,
            actual=max(revolution.override, LEAST_WAY * keep.floor),
            floor=keep.floor,
            ceiling=keep.ceiling,
        )
        if not aims.look_ahead:
            return known
        preview = self.preview
        way = revolution.period * max(revolution.override, LEAST_WAY)
        return replace(
            known,
            expected=preview.mean(revolution.progress_before, revolution.progress),
            ahead=preview.ahead(revolution.progress, revolution=way, count=aims.look_ahead),
        )


def _way(reading: Reading) -> float:
    """S of the program that a revolution takes at the override that is run."""
    return reading.period * reading.teeth * max(reading.override, LEAST_WAY)
