"""Table of the stored verbs over REST: kind of job, request, result and files of each.

A new one needs an entry here, or in ``RESOURCES`` of an extra's module ``rest``, its kind in
:mod:`service.storage.jobs`, its path in :data:`service.rest.views.PLACES`, and its verb in
:data:`service.jobs.verb_job.STORED`. Routes that only one resource has stand in a module of
their own.
"""

from dataclasses import asdict

from service.extra_parts import declared
from service.requests.knowledge import EvaluationRequest, ReviewRequest
from service.requests.runs import ControlRequest, SimulationRequest
from service.requests.stored_cycle_time import StoredCycleTimeRequest
from service.rest.bodies import TrialBody
from service.rest.cycle_time_views import CycleTimeView
from service.rest.orders import (
    runnable,
    selectable,
    startable,
    timeable,
)
from service.rest.resource import CSV_OR_PARQUET, Creation, Download, Resource, Shown
from service.rest.views import SimulationView
from service.storage.jobs import JobKind
from service.storage.results import SAMPLES, TABLE
from service.trial.inputs import Inputs

RUN_STATUS = (
    "Show inputs, feeds, force, power and the active limit; null before the run begins."
)

USUAL = {"content": {"application/json": {"example": {"inputs": asdict(Inputs())}}}}
"""Example request of a trial cut; the service fills in missing inputs with these values."""

RESOURCES = (
    Resource(kind=JobKind.ADVICE, tag="advice", plural="advice"),
    Resource(
        kind=JobKind.CONTROL,
        tag="control",
        plural="runs under control",
        creation=Creation(
            name="ask_control",
            body=ControlRequest,
            require=runnable,
            summary="Run a program under control",
            about="Queue a job that runs a program on the virtual machine under force control.",
        ),
        shown=Shown(summary="Show the result", about="Show the result of a finished run."),
        downloads=(
            Download(
                path="samples",
                file=SAMPLES,
                summary="Download the run as Parquet",
                about="Download the samples of a run, one row per revolution.",
            ),
        ),
        status=RUN_STATUS,
        has_series=True,
    ),
    Resource(
        kind=JobKind.TRIAL,
        tag="control",
        plural="trial cuts",
        creation=Creation(
            name="ask_trial",
            body=TrialBody,
            require=startable,
            summary="Begin a trial cut",
            about="Queue a trial: a constant cut whose inputs can be changed while it goes on.",
            extra={"requestBody": USUAL},
        ),
        shown=Shown(summary="Show the result", about="Show the result of a finished run."),
        report="",
        status=RUN_STATUS,
        has_series=True,
    ),
    Resource(
        kind=JobKind.SIMULATION,
        tag="simulations",
        plural="simulations",
        creation=Creation(
            name="ask",
            body=SimulationRequest,
            require=runnable,
            summary="Simulate a program",
            about="Queue a simulation job; watch its events, then read its result.",
        ),
        shown=Shown(
            summary="Show the result of a simulation",
            about="Show time, energy, peaks and removal of the run and of each workingstep.",
            view=SimulationView,
        ),
        downloads=(
            Download(
                path="samples",
                file=SAMPLES,
                summary="Download the samples as Parquet",
                about="Download the samples as ``stepnc simulate -o run.parquet`` writes them.",
            ),
        ),
        has_series=True,
    ),
    Resource(
        kind=JobKind.CYCLE_TIME,
        tag="verifications",
        plural="cycle times",
        creation=Creation(
            name="ask",
            body=StoredCycleTimeRequest,
            require=timeable,
            summary="Estimate a cycle time",
            about="Queue a job that estimates the time of a program by block; a log adds the "
            "actual time.",
        ),
        shown=Shown(
            summary="Show a cycle time",
            about="Show times by workingstep and tool, the blocks that lose most, and hints.",
            view=CycleTimeView,
        ),
    ),
    Resource(
        kind=JobKind.EVALUATION,
        tag="knowledge",
        plural="tables",
        creation=Creation(
            name="ask_evaluation",
            body=EvaluationRequest,
            require=selectable,
            summary="Compute a table",
            about="Queue a job that compares planned with actual values, feature by feature.",
        ),
        shown=Shown(
            summary="Show a table",
            about="Show the rows of a table with roughing and finishing values, grades and "
            "remarks.",
        ),
        report="evaluation_report",
        downloads=(
            Download(
                path="table",
                file=TABLE,
                forms=CSV_OR_PARQUET,
                name="evaluation_file",
                summary="Download a table as a file",
                about="Download a table with one line for each side (roughing, finishing) of a "
                "row.",
            ),
        ),
    ),
    Resource(
        kind=JobKind.REVIEW,
        tag="knowledge",
        plural="reviews",
        creation=Creation(
            name="ask_review",
            body=ReviewRequest,
            require=selectable,
            summary="Learn from outcomes",
            about="Queue a job that proposes corrections, which a person may then accept.",
        ),
        shown=Shown(
            summary="Show the result of a review",
            about="Show each context with its factor on k_c, the objections to it, and the "
            "action taken.",
        ),
        report="",
    ),
    *declared("rest", "RESOURCES"),
)
