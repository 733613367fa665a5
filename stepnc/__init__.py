"""STEP-NC optimisation from Python: every verb of the command line is a function.

    times = stepnc.cycletime("part.stpnc", machine="vmc15")
    times.to_pandas()

Arguments are the files in the order of the command line, then the fields of the request as
keywords, in the units that their names end with. A result has ``table()`` (Arrow),
``to_pandas()``, ``plot()``, ``save()`` and the ``exit_code`` of the command line; printed, and
in a notebook, it shows what the command line prints. Messages go to the logger ``stepnc``.
"""

import logging
from collections.abc import Callable

from service.verbs.call import Verb, call, verbs
from service.verbs.result import Result
from stepnc_model.errors import StepNcError as StepNcError

LOG = logging.getLogger("stepnc")


def __getattr__(name: str) -> Callable[..., Result]:
    for verb in verbs().values():
        if verb.function == name:
            return _function(verb)
    raise AttributeError(f"module 'stepnc' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(["Result", "StepNcError", *(each.function for each in verbs().values())])


def _function(verb: Verb) -> Callable[..., Result]:
    """Return the function of a verb, with its help."""

    def function(*args: object, **words: object) -> Result:
        return call(verb, args, words, tell=LOG.info)

    function.__name__ = function.__qualname__ = verb.function
    function.__module__ = "stepnc"
    function.__doc__ = verb.about
    return function
