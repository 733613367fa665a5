"""Jobs of the factory, found by the runner of jobs."""

from service.storage.jobs import JobKind

WORK = ((JobKind.FACTORY, "extras.factory.shop_job:run"),)
