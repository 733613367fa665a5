"""Request of ``kbe check``."""

from service.requests.fields import Request
from service.verbs.kbe.places import KnowledgeFiles

REQUEST, FILES = Request, KnowledgeFiles
