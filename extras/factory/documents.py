"""MTConnect documents of the first parts of each machine, by runs of the virtual machine.

Each part is run with its own settings. Where settings are as programmed, the movements deviate
in power by the factors that were drawn for the part, so that the run has the energy of the
table of parts. Where settings are drawn, times and energies of the table are interpolated, and
the run has a deviation of its own: both differ a little. ELECTRICAL_ENERGY of a document adds
up samples.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path

import numpy as np

from extras.agent.model.machine_feed import run_feed
from extras.agent.model.machine_model import machine_model
from extras.agent.run import PublishedRun, streams_document
from extras.factory.cycles import place_text
from extras.factory.devices import device_names
from extras.factory.model.cycle import Factors, drawn_factors
from extras.factory.model.machining import MachiningPlan, Place, purpose_of
from extras.factory.model.records import PartMade
from extras.factory.model.shop import Shop
from extras.factory.model.streams import Streams
from service.files import plain_name, write_atomically
from service.programs.machine_choice import material_for
from service.programs.reading import read_program
from service.progress import Tell, Ticker, bar, silent
from service.requests.runs import SimulationRequest
from service.simulation.run import machine_of
from service.simulation.setup import prepared_program
from simulator.machine.deviation import GivenDeviation, SeededDeviation, movement_kinds
from simulator.machine.interpreter import interpret
from simulator.machine.samples import Samples, joined
from simulator.machine.sensing import Sampler
from simulator.machine.virtual import VirtualMachine
from simulator.motion.segments import Bools, Floats
from simulator.spec import Machine, MaterialMatch
from stepnc_model.editing.cut_settings import with_settings
from stepnc_model.errors import StepNcError, WriteError
from stepnc_model.programs.program import Program

RATE = 20.0
"""Samples per second, as those of ``stepnc simulate``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ChosenPart:
    """Part of which a document is written."""

    made: PartMade
    number: int
    """Number of the part among those of its place, from 0."""

    @property
    def place(self) -> Place:
        """Indices of product, step and machine."""
        return self.made.product, self.made.step, self.made.machine

    @property
    def id(self) -> str:
        """Id of the part, as in the tables of parts."""
        return f"{self.made.batch}-{self.made.part}"


class FirstParts:
    """Gathers the first parts of each machine. Running state.

    Parameters
    ----------
    most : int
        Most parts of each machine.
    """

    def __init__(self, most: int) -> None:
        self.parts: list[ChosenPart] = []
        self._most = most
        self._of_machine: Counter[int] = Counter()
        self._of_place: Counter[Place] = Counter()

    def part(self, made: PartMade) -> None:
        """Keep a part, while its machine has few."""
        if self._of_machine[made.machine] >= self._most:
            return
        place = (made.product, made.step, made.machine)
        self.parts.append(ChosenPart(made=made, number=self._of_place[place]))
        self._of_machine[made.machine] += 1
        self._of_place[place] += 1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class PartRun:
    """Run of one part on its machine."""

    virtual: VirtualMachine
    samples: Samples
    is_rapid: Bools
    """Whether each movement of the run is a rapid."""


class PartDocuments:
    """Writes documents of the parts of a shop. Running state.

    Parameters
    ----------
    streams : Streams
        Of the replication whose parts they are.
    """

    def __init__(
        self, shop: Shop, plan: MachiningPlan, streams: Streams, *, tell: Tell
    ) -> None:
        self._shop, self._plan, self._streams, self._tell = shop, plan, streams, tell
        self._names = device_names([machine.name for machine in shop.machines])
        self._programs: dict[tuple[str, str], tuple[Program, MaterialMatch]] = {}
        self._factors: dict[Place, Iterator[Factors]] = {}
        self._kinds: dict[Place, Bools] = {}

    def write(self, parts: Sequence[ChosenPart], folder: Path) -> int:
        """Write a document of each part into a folder; how many were written.

        Each file is written as a whole, so that an interrupted run leaves documents only.

        Raises
        ------
        StepNcError
            When the machine cannot run a part.
        WriteError
            When the disk refuses.
        """
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise WriteError(error.strerror or str(error), path=str(folder)) from error
        ticker, count, left_out = Ticker(self._tell), 0, set[str]()
        for part in parts:
            product = self._shop.products[part.made.product]
            spec = self._shop.machines[part.made.machine]
            if not product.steps[part.made.step].program or spec.machine is None:
                left_out.add(f"step {part.made.step + 1} of {product.name} on {spec.name}")
                continue
            document = streams_document(self.published(part))
            write_atomically(folder / f"{plain_name(f'{spec.name}_{part.id}')}.xml", document)
            count += 1
            ticker(lambda done=count: f"{bar(done / len(parts))}  {done} documents")  # type: ignore[misc]
        for each in sorted(left_out):
            self._tell(f"no document of {each}: it has a time and no program")
        return count

    def published(self, part: ChosenPart) -> PublishedRun:
        """Run a part, and return it as observations.

        Raises
        ------
        StepNcError
            When the machine cannot run the part.
        """
        run = self.run(part)
        spec = replace(run.virtual.machine, name=self._names[part.made.machine])
        model = machine_model(spec)
        workingsteps = tuple(run.virtual.workingsteps)
        tools = run.virtual.setup.tools or {}
        step = self._shop.products[part.made.product].steps[part.made.step]
        return PublishedRun(
            program=Path(step.program).name,
            machine=spec,
            model=model,
            feed=run_feed(run.samples, spec, model, workingsteps=workingsteps),
            tools=tuple(tools[number] for number in sorted(tools)),
            part=part.id,
            batch=str(part.made.batch),
        )

    def run(self, part: ChosenPart) -> PartRun:
        """Run a part with its own settings and deviation.

        Raises
        ------
        StepNcError
            When the machine cannot run the part.
        """
        product, step, row = part.place
        machine = self._shop.machines[row].machine
        path = self._shop.products[product].steps[step].program
        if machine is None:
            raise StepNcError(f"{path}: its machine has only times")
        program, material = self._program(path, self._shop.products[product].material)
        if part.place in self._plan.tables:
            told = with_settings(program, part.made.settings)
            own = _seeded(machine, self._streams, f"{path} {part.id}")
            return _run(told, machine, material, deviation=own)
        given = None
        if machine.deviation is not None:
            factors = self._factors_of(part, machine)
            if part.place not in self._kinds:
                plain = _run(program, machine, material, deviation=None)
                self._kinds[part.place] = plain.is_rapid
            given = GivenDeviation(factors=_in_order(factors, self._kinds[part.place]))
        return _run(program, machine, material, deviation=given)

    def _program(self, path: str, material: str) -> tuple[Program, MaterialMatch]:
        key = (path, material)
        if key not in self._programs:
            program = read_program(Path(path), units="iso")
            self._programs[key] = program, material_for(material, program)
        return self._programs[key]

    def _factors_of(self, part: ChosenPart, machine: Machine) -> Factors:
        """Factors that were drawn for a part; parts of a place come in their order."""
        place = part.place
        if place not in self._factors:
            name, purpose = self._shop.machines[place[2]].name, purpose_of(self._shop, place)
            rng = self._streams.generator(name, purpose)
            cycle = self._plan.cycles[place].cycle
            if machine.deviation is None:
                raise StepNcError(f"machine '{machine.name}' states no power deviation")
            self._factors[place] = drawn_factors(cycle, machine.deviation, rng)
        return next(self._factors[place])


def _run(
    program: Program,
    machine: Machine,
    material: MaterialMatch,
    *,
    deviation: SeededDeviation | GivenDeviation | None,
) -> PartRun:
    """Run a program on the virtual machine."""
    prepared = prepared_program(program, machine, material, tell=silent)
    setup = machine_of(SimulationRequest(), prepared).setup
    virtual = VirtualMachine(replace(setup, deviation=deviation))
    sampler, parts, kinds = Sampler(machine, rate=RATE), list[Samples](), list[Bools]()
    try:
        for episode in virtual.run(interpret(prepared.blocks, machine)):
            parts += sampler.samples(episode)
            if episode.course is not None:
                kinds.append(movement_kinds(episode.course.segments))
    except StepNcError as error:
        raise StepNcError(f"{place_text(program, machine)}: {error}") from error
    is_rapid = np.concatenate([np.zeros(0, dtype=bool), *kinds])
    return PartRun(virtual=virtual, samples=joined(parts), is_rapid=is_rapid)


def _in_order(factors: Factors, is_rapid: Bools) -> Floats:
    """Factors of the movements in the order of the run."""
    found = np.empty(len(is_rapid))
    found[is_rapid], found[~is_rapid] = factors
    return found


def _seeded(machine: Machine, streams: Streams, name: str) -> SeededDeviation | None:
    """Deviation of a part, by the seed of the run and the part's name."""
    if machine.deviation is None:
        return None
    words = f"{streams.seed}\0{machine.name}\0{name}".encode()
    seed = int.from_bytes(blake2b(words, digest_size=4).digest())
    return SeededDeviation(deviation=machine.deviation, seed=seed)
