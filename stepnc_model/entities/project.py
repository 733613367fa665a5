"""The project: the root of a program, with owner, date and status (ISO 14649-10)."""

from __future__ import annotations

from stepnc_model.entities.entity import Entity, entity
from stepnc_model.entities.enums import AheadOrBehind
from stepnc_model.entities.executables import Workplan
from stepnc_model.entities.workpiece import Workpiece
from stepnc_model.part21.values import Ref


@entity
class Person(Entity):
    """Person (ISO 10303-41)."""

    id: str
    last_name: str | None = None
    first_name: str | None = None
    middle_names: tuple[str, ...] | None = None
    prefix_titles: tuple[str, ...] | None = None
    suffix_titles: tuple[str, ...] | None = None


@entity
class Address(Entity):
    """Address (ISO 10303-41)."""

    internal_location: str | None = None
    street_number: str | None = None
    street: str | None = None
    postal_box: str | None = None
    town: str | None = None
    region: str | None = None
    postal_code: str | None = None
    country: str | None = None
    facsimile_number: str | None = None
    telephone_number: str | None = None
    electronic_mail_address: str | None = None
    telex_number: str | None = None


@entity
class PersonAndAddress(Entity):
    """Who owns the project."""

    its_person: Ref[Person]
    its_address: Ref[Address] | None = None


@entity
class CalendarDate(Entity):
    """Day (ISO 10303-41)."""

    year_component: int
    day_component: int
    month_component: int


@entity
class CoordinatedUniversalTimeOffset(Entity):
    """Time zone (ISO 10303-41)."""

    hour_offset: int
    minute_offset: int | None = None
    sense: AheadOrBehind


@entity
class LocalTime(Entity):
    """Time of the day (ISO 10303-41)."""

    hour_component: int
    minute_component: int | None = None
    second_component: float | None = None
    zone: Ref[CoordinatedUniversalTimeOffset]


@entity
class DateAndTime(Entity):
    """Moment (ISO 10303-41)."""

    date_component: Ref[CalendarDate]
    time_component: Ref[LocalTime]


@entity
class ApprovalStatus(Entity):
    """Name of a status (ISO 10303-41)."""

    name: str


@entity
class Approval(Entity):
    """Status with its level (ISO 10303-41)."""

    status: Ref[ApprovalStatus]
    level: str


@entity
class Project(Entity):
    """Root of a program."""

    its_id: str
    main_workplan: Ref[Workplan]
    its_workpieces: tuple[Ref[Workpiece], ...]
    its_owner: Ref[PersonAndAddress] | None = None
    its_release: Ref[DateAndTime] | None = None
    its_status: Ref[Approval] | None = None
