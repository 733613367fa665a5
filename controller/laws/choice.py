"""Selection of a control law by name."""

from enum import StrEnum
from typing import Any

from controller.laws.fuzzy import Fuzzy
from controller.laws.law import ControlLaw, Plant
from controller.laws.log_pi import LogPI
from controller.laws.model_reference import ModelReference
from controller.laws.open_loop import OpenLoop
from controller.laws.pi import PI
from controller.laws.previewed import Previewed
from controller.laws.self_tuning import SelfTuning


class LawName(StrEnum):
    """Names of the control laws that a user can choose."""

    PI = "pi"
    LOG_PI = "log-pi"
    FUZZY = "fuzzy"
    SELF_TUNING = "self-tuning"
    MRAC = "mrac"
    MPC = "mpc"
    NONE = "none"


def law_named(name: LawName, plant: Plant, *, has_preview: bool) -> ControlLaw[Any]:
    """Create a control law tuned for a plant; the type of its state depends on the law.

    Parameters
    ----------
    name : LawName
        MPC has its own preview, used whenever the cut ahead is known.
    plant : Plant
        Process model for which the law is tuned.
    has_preview : bool
        Whether situations include the expected force ahead.
    """
    match name:
        case LawName.MPC:
            # Imported late because OSQP is slow to import.
            from controller.laws.mpc import ModelPredictive  # noqa: PLC0415

            return ModelPredictive(plant=plant)
        case LawName.NONE:
            return OpenLoop()
    law = _feedback(name, plant)
    return Previewed(law=law, plant=plant) if has_preview else law


def _feedback(name: LawName, plant: Plant) -> ControlLaw[Any]:
    """Create a control law with feedback only."""
    match name:
        case LawName.PI:
            return PI(plant=plant)
        case LawName.FUZZY:
            return Fuzzy(plant=plant)
        case LawName.SELF_TUNING:
            return SelfTuning(plant=plant)
        case LawName.MRAC:
            return ModelReference(plant=plant)
        case _:
            return LogPI(plant=plant)
