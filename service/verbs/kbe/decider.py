"""Name of the person who decides on corrections."""

import getpass

from service.progress import Tell
from service.verbs.kbe.places import DeciderFiles
from stepnc_model.errors import StepNcError


def decider(files: DeciderFiles, *, tell: Tell) -> str:
    """Return the name that is given; the login name if none is.

    Raises
    ------
    StepNcError
        When none is given and the user has no login name.
    """
    if files.by.strip():
        return files.by
    try:
        name = getpass.getuser()
    except (KeyError, OSError) as error:
        raise StepNcError(
            "no login name found; give the name of the person who decides with --by NAME"
        ) from error
    tell(f"decision recorded for login '{name}'; use --by NAME for another person")
    return name
