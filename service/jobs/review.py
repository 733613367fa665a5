"""Job ``review``: corrections proposed from the outcomes of the knowledge base."""

import json

from service.jobs.task import RunningJob
from service.knowledge.review import review
from service.knowledge.review_output import review_json
from service.requests.knowledge import ReviewRequest


def run(task: RunningJob) -> None:
    """Review recorded outcomes and propose corrections.

    Raises
    ------
    KnowledgeError
        When the knowledge base cannot be read or written.
    """
    found = review(task.data_folder.knowledge, task.request(ReviewRequest))
    task.keep(json.loads(review_json(found)))
