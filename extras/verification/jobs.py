"""Jobs of verifications, found by the runner of jobs."""

from extras.verification.stored_request import QueuedVerification
from service.jobs.stored_verb import StoredVerb
from service.storage.jobs import JobKind

STORED = ((JobKind.VERIFICATION, StoredVerb(name="verify", request=QueuedVerification)),)
