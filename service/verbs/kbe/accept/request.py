"""Request of ``kbe accept``."""

from service.verbs.kbe.places import DeciderFiles, DecisionRequest

REQUEST, FILES = DecisionRequest, DeciderFiles
