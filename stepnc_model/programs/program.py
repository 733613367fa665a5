"""STEP-NC program: its workingsteps in order, and the entities that each refers to.

Loading does not fail on deviations that leave the program usable; they are findings. A problem
that makes a workingstep unusable is an error finding, raised when the workingstep is requested.
"""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol, TypeVar

from stepnc_model.ap238.view import AimView, is_aim
from stepnc_model.entities.entity import Entity
from stepnc_model.entities.executables import (
    MachiningWorkingstep,
    Project,
    Setup,
    TurningWorkingstep,
)
from stepnc_model.entities.measures import PropertyParameter
from stepnc_model.entities.milling import DrillingTypeOperation
from stepnc_model.entities.operations import MachiningOperation
from stepnc_model.entities.profiles import MachinedSurface, SurfaceTextureParameter
from stepnc_model.entities.workpiece import Material, Workpiece
from stepnc_model.errors import Finding, FindingList, PathError, SchemaError, Severity
from stepnc_model.part21.reader import Part21File
from stepnc_model.part21.values import Ref
from stepnc_model.programs.binding import Model, is_of_file
from stepnc_model.programs.path_technology import technologies_of
from stepnc_model.programs.program_listing import ProgramLine, program_lines
from stepnc_model.programs.remedy import error_of, with_remedy
from stepnc_model.programs.user_tools import GivenTool
from stepnc_model.units import ISO, UnitProfile


@dataclass(frozen=True, slots=True, kw_only=True)
class Stock:
    """Raw part in setup coordinates: a box, or a bar about an axis along z, mm."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]
    radius: float | None = None
    """Radius of a bar, mm; its axis is in the middle of the box."""
    is_around: bool = False
    """Whether it stands around a raw part of another shape."""

    def grown(self, margin: float) -> "Stock":
        """Stock that is larger by a margin on all sides, mm."""
        x, y, z = self.low
        right, back, top = self.high
        return replace(
            self,
            low=(x - margin, y - margin, z - margin),
            high=(right + margin, back + margin, top + margin),
            radius=None if self.radius is None else self.radius + margin,
        )


class Bodies(Protocol):
    """Reader of B-rep bodies, whose geometry this package does not know."""

    def box(self, file: Part21File, representation: int) -> Stock | None:
        """Box or bar around a body, by the instance of its shape representation.

        In coordinates of its workpiece; None: it is not known.
        """
        ...


T = TypeVar("T")

Texture = tuple[SurfaceTextureParameter, MachinedSurface]


@dataclass(frozen=True, slots=True, kw_only=True)
class ResolvedWorkingstep:
    """Workingstep with the entities that it refers to."""

    ref: Ref[Entity]
    id: str
    operation_ref: Ref[Entity]
    operation: MachiningOperation
    features: tuple[Ref[Entity], ...]
    tool_ref: Ref[Entity]
    functions_ref: Ref[Entity] | None
    setup: Ref[Setup] | None
    index: int
    """Position among the workingsteps of the program, from 0."""
    is_last_on_feature: bool
    """Whether no later workingstep works on the same feature."""
    technologies: tuple[Ref[Entity], ...]
    """Technologies that its feed stands in, the first for all: they have the same values."""

    @property
    def technology_ref(self) -> Ref[Entity]:
        """Technology with its feed and speed."""
        return self.technologies[0]

    @property
    def operation_type(self) -> str:
        """EXPRESS name of the operation, such as ``plane_rough_milling``."""
        return self.operation.keyword.lower()


class Program:
    """STEP-NC program of one file, with its executables in order.

    Parameters
    ----------
    units : UnitProfile
        Units in which the file writes feeds and speeds.
    name : str
        File name, for messages.
    stock : Stock, optional
        Raw part to use if the file does not describe one.
    bodies : Bodies, optional
        Reader of raw parts that are B-rep bodies; without one they are not known.
    tools : sequence of GivenTool, optional
        Tools of which the file may have nothing but the name.
    """

    def __init__(
        self,
        file: Part21File,
        *,
        units: UnitProfile = ISO,
        name: str = "",
        stock: Stock | None = None,
        bodies: Bodies | None = None,
        tools: Sequence[GivenTool] = (),
    ) -> None:
        self.name = name
        self.bodies = bodies
        self.tools = tools
        self.stock = stock
        """Raw part given by the user, for a file that does not describe one."""
        self.units = units
        self.source = file
        """File as it was read: of ISO 14649, or of AP238."""
        self.file = _nouns_of(file)
        """Instances of ISO 14649: the file itself, or what an AP238 file describes."""
        if self.file is not file and units is not ISO:
            raise SchemaError(
                f"an AP238 file names its units: units '{units.name}' do not apply"
            )
        self.model = Model(self.file)
        self._faults: dict[int, SchemaError] = {}
        self.executables = tuple(program_lines(self.model, self.error, self._faults))
        self.workingsteps = tuple(self._workingsteps())
        self._textures: dict[int, list[Texture]] | None = None
        self._by_feature: dict[int, list[ResolvedWorkingstep]] = {}
        self._named: dict[str, list[Ref[Entity]]] | None = None
        self._drilling, self._other = _technologies(self.workingsteps)
        for step in self.workingsteps:
            for feature in step.features:
                self._by_feature.setdefault(int(feature), []).append(step)

    @classmethod
    def load(cls, path: Path, *, units: UnitProfile = ISO) -> "Program":
        """Read a file; Part21Error or SchemaError if it is not a STEP-NC program."""
        return cls(
            Part21File.from_bytes(path.read_bytes(), name=path.name),
            units=units,
            name=path.name,
        )

    def changed(self, file: Part21File) -> "Program":
        """Program of a changed file: its units, name, raw part and bodies stay."""
        return Program(
            file,
            units=self.units,
            name=self.name,
            stock=self.stock,
            bodies=self.bodies,
            tools=self.tools,
        )

    def get(self, ref: Ref[T]) -> T:
        """Entity behind a reference."""
        return self.model.get(ref)

    def parameters_named(self, prefix: str) -> dict[str, list[Ref[Entity]]]:
        """Numeric and descriptive parameters of the file by name, those with a prefix."""
        if self._named is None:
            self._named = {}
            for ref, parameter in self.model.of_type(PropertyParameter):
                self._named.setdefault(parameter.parameter_name, []).append(ref)
        return {name: refs for name, refs in self._named.items() if name.startswith(prefix)}

    def units_of(self, technology: Ref[Entity]) -> UnitProfile:
        """Units of the feeds and speeds of a technology.

        Raises
        ------
        SchemaError
            If drilling and another operation share the technology, and the profile gives them
            different units.
        """
        if self.units.drilling_feed is None or int(technology) not in self._drilling:
            return self.units
        if int(technology) in self._other:
            message = "drilling and milling share it, and their feeds have different units"
            raise self.error(message, technology, "feedrate")
        return self.units.for_drilling()

    def line(self, ref: Ref[Entity]) -> int:
        """Line of an instance, counted from 1."""
        return self.file.line(int(ref))

    def label(self, ref: Ref[Entity]) -> str:
        """Instance as messages name it, ``#19 DRILLING``."""
        return self.file.label(int(ref))

    def error(self, message: str, ref: Ref[Entity], attribute: str = "") -> SchemaError:
        """Create an error about one instance, with the option that sets the attribute."""
        text = with_remedy(message, self.label(ref), attribute)
        return SchemaError(
            text, entity=self.label(ref), attribute=attribute, line=self.line(ref)
        )

    def path_error(self, message: str, ref: Ref[Entity], attribute: str = "") -> PathError:
        """Create an error that no tool path can be made because of one instance."""
        text = with_remedy(message, self.label(ref), attribute)
        return PathError(text, entity=self.label(ref), attribute=attribute, line=self.line(ref))

    def finding(
        self, severity: Severity, message: str, ref: Ref[Entity], attribute: str = ""
    ) -> Finding:
        """Create a finding about one instance."""
        return Finding(
            severity=severity,
            message=message,
            entity=self.label(ref),
            attribute=attribute,
            line=self.line(ref),
        )

    @contextmanager
    def using(self, ref: Ref[Entity], *near: Ref[Any] | None) -> Iterator[None]:
        """Convert errors from missing or invalid attributes to errors that name an instance.

        The binding is tolerant: an entity may hold None or an invalid number where the schema
        requires a value. The code that uses it then fails, and here the error gets a place: the
        nearest fault among the given instances and their references. A mistake of code passes.
        """
        try:
            yield
        except ValueError as error:
            if "empty sequence" not in str(error):
                raise self.error(str(error), ref) from error
            fault = self.model.fault_near(ref, *(other for other in near if other is not None))
            if fault is None:
                raise self.error("a list of values has none", ref) from error
            raise error_of(fault) from error
        except (ArithmeticError, AttributeError, IndexError, TypeError) as error:
            fault = self.model.fault_near(ref, *(other for other in near if other is not None))
            if not is_of_file(error, fault):
                raise
            if fault is None:
                message = "a required attribute is missing, of the wrong type, or out of range"
                raise self.error(message, ref) from error
            raise error_of(fault) from error

    @property
    def faults(self) -> tuple[SchemaError, ...]:
        """Errors of the workingsteps that cannot be used."""
        return tuple(self._faults.values())

    def fault_of(self, ref: Ref[Entity]) -> SchemaError | None:
        """Error that makes an executable unusable, or None."""
        return self._faults.get(int(ref))

    def findings(self) -> tuple[Finding, ...]:
        """All findings about syntax, schema and program structure."""
        faults = FindingList()
        faults.extend(
            Finding(
                severity=Severity.ERROR,
                message=fault.rule,
                entity=fault.entity,
                attribute=fault.attribute,
                line=fault.line,
            )
            for fault in self.faults
        )
        return self.file.findings + self.model.findings() + faults.all()

    def before(self, step: ResolvedWorkingstep) -> list[ResolvedWorkingstep]:
        """Workingsteps on the same features that run before this one, in order."""
        return [other for other in self._on_features_of(step) if other.index < step.index]

    def after(self, step: ResolvedWorkingstep) -> list[ResolvedWorkingstep]:
        """Workingsteps on the same features that run after this one, in order."""
        return [other for other in self._on_features_of(step) if other.index > step.index]

    def _on_features_of(self, step: ResolvedWorkingstep) -> list[ResolvedWorkingstep]:
        """Workingsteps on the same features as the given one, in order."""
        features = (self._by_feature[int(feature)] for feature in step.features)
        found = {int(other.ref): other for each in features for other in each}
        return sorted(found.values(), key=lambda other: other.index)

    def textures_of(self, feature: Ref[Entity]) -> list[Texture]:
        """Required textures of a feature, each with the surface that it applies to."""
        if self._textures is None:
            self._textures = {}
            for _, texture in self.model.of_type(SurfaceTextureParameter):
                for surface in map(self.get, texture.applied_surfaces):
                    pairs = self._textures.setdefault(int(surface.its_machining_feature), [])
                    pairs.append((texture, surface))
        return self._textures.get(int(feature), [])

    def workpiece(self) -> Workpiece | None:
        """Workpiece of the project, or the first one in the file."""
        for _, project in self.model.of_type(Project):
            if project.its_workpieces:
                ref = project.its_workpieces[0]
                workpiece = self.get(ref)
                if not isinstance(workpiece, Workpiece):
                    raise self.error("is not a workpiece, where one is expected", ref)
                return workpiece
        return next((workpiece for _, workpiece in self.model.of_type(Workpiece)), None)

    def material(self) -> Material | None:
        """Material of the workpiece, or None if the file names none."""
        workpiece = self.workpiece()
        if workpiece is None or workpiece.its_material is None:
            return None
        material = self.get(workpiece.its_material)
        if not isinstance(material, Material):
            raise self.error("is not a material, where one is expected", workpiece.its_material)
        return material

    def _workingsteps(self) -> Iterator[ResolvedWorkingstep]:
        """Workingsteps in order; problems of a workingstep are recorded as faults."""
        last: dict[int, int] = {}
        found: list[ResolvedWorkingstep] = []
        for executable in self.executables:
            if executable.is_open:
                continue
            try:
                step = self._workingstep(executable)
            except SchemaError as fault:
                self._faults[int(executable.ref)] = fault
                continue
            if step is None:
                continue
            for feature in step.features:
                last[int(feature)] = len(found)
            found.append(step)
        for index, step in enumerate(found):
            is_last = any(last[int(feature)] == index for feature in step.features)
            yield replace(step, index=index, is_last_on_feature=is_last)

    def _workingstep(self, executable: ProgramLine) -> ResolvedWorkingstep | None:
        """Resolve one workingstep; None if the executable is not a workingstep."""
        at = executable.ref
        entity = self.model.entity(int(at))
        if isinstance(entity, MachiningWorkingstep):
            feature = entity.its_feature
            features: tuple[Ref[Entity], ...] = (feature,) if feature is not None else ()
        elif isinstance(entity, TurningWorkingstep):
            features = tuple(entity.its_features)
        else:
            return None
        if entity.its_operation is None:
            raise self.error("the workingstep has no operation", at, "its_operation")
        operation = self.get(entity.its_operation)
        if not isinstance(operation, MachiningOperation):
            raise self.error("is not a machining operation", entity.its_operation)
        if operation.its_tool is None:
            raise self.error("the operation has no tool", entity.its_operation, "its_tool")
        technologies = technologies_of(self.model, operation)
        if not technologies:
            raise self.error(
                "the operation has no technology", entity.its_operation, "its_technology"
            )
        for ref in (operation.its_tool, technologies[0], *features):
            self.get(ref)
        return ResolvedWorkingstep(
            ref=at,
            id=entity.its_id,
            operation_ref=entity.its_operation,
            operation=operation,
            features=features,
            tool_ref=operation.its_tool,
            technologies=technologies,
            functions_ref=operation.its_machine_functions,
            setup=executable.setup,
            index=0,
            is_last_on_feature=False,
        )


def _nouns_of(file: Part21File) -> Part21File:
    """File whose instances are those of ISO 14649."""
    if isinstance(file, AimView) or not is_aim(file):
        return file
    return AimView.of(file)


def _technologies(steps: tuple[ResolvedWorkingstep, ...]) -> tuple[set[int], set[int]]:
    """Instance numbers of the technologies of drilling, and of all other operations."""
    drilling: set[int] = set()
    other: set[int] = set()
    for step in steps:
        is_drilling = isinstance(step.operation, DrillingTypeOperation)
        (drilling if is_drilling else other).add(int(step.technology_ref))
    return drilling, other
