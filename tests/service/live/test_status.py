"""How a run is, as others read it: JSON, names with their units."""

import json

from service.live.runner import UNITS
from service.trial.inputs import Inputs
from service.trial.run import TrialRun


def test_a_status_is_json_and_its_names_carry_units() -> None:
    run = TrialRun(Inputs())
    run.advance(1.0)
    words = run.snapshot()
    assert json.loads(json.dumps(words)) == words
    assert words["time_s"] == run.time
    assert words["force_predicted_n"] > 0.0
    assert not set(words) & set(UNITS)


def test_choices_are_words_and_inputs_stay_together() -> None:
    words = TrialRun(Inputs()).snapshot()
    assert words["inputs"]["mode"] == Inputs().mode.value
    assert words["inputs"]["teeth"] == Inputs().teeth
    assert isinstance(words["level"], str)
