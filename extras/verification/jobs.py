"""Jobs of verifications, found by the runner of jobs."""

from service.jobs.stored_verb import StoredVerb
from service.requests.stored_verification import QueuedVerification
from service.storage.jobs import JobKind

STORED = ((JobKind.VERIFICATION, StoredVerb(name="verify", request=QueuedVerification)),)
