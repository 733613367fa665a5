"""Request of ``kbe withdraw``."""

from service.verbs.kbe.places import DeciderFiles, DecisionRequest

REQUEST, FILES = DecisionRequest, DeciderFiles
