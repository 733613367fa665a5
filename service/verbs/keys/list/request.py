"""Request of ``keys list``."""

from service.requests.fields import Request
from service.verbs.keys.places import ServiceFiles

REQUEST, FILES = Request, ServiceFiles
