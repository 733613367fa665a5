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

from service.verbs.call import call
from service.verbs.result import Result
from service.verbs.verb import Verb, verbs
from stepnc_model.errors import StepNcError as StepNcError

LOG = logging.getLogger("stepnc")


def __getattr__(name: str) -> Callable[..., Result]:
    verb = verbs().get(name)
    if verb is None:
        raise AttributeError(f"module 'stepnc' has no attribute '{name}'")
    return _function(verb)


def __dir__() -> list[str]:
    return sorted(["Result", "StepNcError", *verbs()])


def _function(verb: Verb) -> Callable[..., Result]:
    """Return the function of a verb, with its help."""

    def function(*args: object, **words: object) -> Result:
        return call(verb, args, words, tell=LOG.info)

    function.__name__ = function.__qualname__ = verb.folder
    function.__module__ = "stepnc"
    function.__doc__ = verb.about
    return function
