"""Requests in the words that people type, beside the files that they name."""

from pathlib import Path

from controller.laws.choice import LawName
from controller.orders import Criterion
from controller.signals.preview import LOOK_AHEAD
from optimiser.modes import Free, Mode
from optimiser.safety import USUAL_QUANTILE
from service.requests.advice import AdviceRequest
from service.requests.fields import member_of
from service.requests.program_facts import Units
from service.requests.runs import ControlRequest, ForceView, SensorChoice, SimulationRequest
from service.simulation.code_simulation import CodeRequest
from service.simulation.run import RunFiles
from service.verbs.optimise.request import AdviceFiles
from simulator.machine.noise_kind import NoiseKind
from simulator.motion.model_name import ControlModelName
from stepnc_model.editing.file_profile import FileProfile
from stepnc_model.post.dialect import Dialect

AskedAdvice = tuple[AdviceRequest, AdviceFiles]
AskedSimulation = tuple[SimulationRequest, RunFiles]
AskedControl = tuple[ControlRequest, RunFiles]


def asked_advice(
    file: Path,
    *,
    mode: str = "TC",
    machine: str = "",
    material: str = "",
    units: str = "iso",
    roughness_um: float | None = None,
    free: str = "feed,depth",
    profile: str = "optimisation",
    output: Path | None = None,
    in_place: bool = False,
    workingsteps: tuple[str, ...] = (),
    pareto: bool = False,
    tool_change: float = 0.0,
    dry_run: bool = False,
    report: Path | None = None,
    control: str = "",
    knowledge: str = "",
    confirm: bool = False,
    stock: str = "",
    holding: Path | None = None,
    safety: float = USUAL_QUANTILE,
    tools: Path | None = None,
    allow_plunge: bool = False,
) -> AskedAdvice:
    """Arguments of :func:`service.advising.run`."""
    request = AdviceRequest(
        mode=member_of(Mode, mode, "mode"),
        machine=machine,
        material=material,
        units=member_of(Units, units, "units"),
        roughness_um=roughness_um,
        free=tuple(member_of(Free, word, "free") for word in free.split(",")),
        profile=member_of(FileProfile, profile, "profile"),
        workingsteps=workingsteps,
        has_pareto=pareto,
        tool_change_s=tool_change,
        nc_control=member_of(Dialect, control, "control") if control else None,
        is_confirmed=confirm,
        stock=stock,
        safety=safety,
        allow_plunge=allow_plunge,
    )
    files = AdviceFiles(
        file=file,
        output=output,
        in_place=in_place,
        dry_run=dry_run,
        report=report,
        holding=holding,
        tools=tools,
        kb=knowledge,
    )
    return request, files


def asked_simulation(
    file: Path | None = None,
    *,
    code: CodeRequest | None = None,
    machine: str = "",
    material: str = "",
    units: str = "iso",
    rate: float = 10.0,
    control: str = "fir",
    filter_s: str = "",
    deviation: float = 0.01,
    zero: str = "",
    noise: str = "none",
    missing: float = 0.0,
    has_lag: bool = False,
    has_wear: bool = False,
    force: str = "mean",
    runout_um: float = 0.0,
    kc_factor: float = 1.0,
    has_power_deviation: bool = False,
    seed: int = 0,
    keep_going: bool = False,
    output: Path | None = None,
    report: Path | None = None,
) -> AskedSimulation:
    """Arguments of :func:`service.simulation.run.simulate`."""
    request = SimulationRequest(
        machine=machine,
        material=material,
        units=member_of(Units, units, "units"),
        rate_hz=rate,
        control=member_of(ControlModelName, control, "control"),
        filter_s=filter_s,
        deviation_mm=deviation,
        zero=zero,
        noise=member_of(NoiseKind, noise, "noise"),
        missing=missing,
        has_lag=has_lag,
        has_wear=has_wear,
        force=member_of(ForceView, force, "force"),
        runout_um=runout_um,
        kc_factor=kc_factor,
        has_power_deviation=has_power_deviation,
        seed=seed,
        keep_going=keep_going,
    )
    return request, RunFiles(file=file, code=code, output=output, report=report)


def asked_control(
    file: Path | None = None,
    *,
    code: CodeRequest | None = None,
    machine: str = "",
    material: str = "",
    mode: str = "TC",
    law: str = "log-pi",
    has_preview: bool = False,
    look_ahead: int = LOOK_AHEAD,
    disturbances: tuple[str, ...] = (),
    seed: int = 0,
    set_point: float | None = None,
    band: tuple[float, float] = (20.0, 120.0),
    sensor: str = "dynamometer",
    output: Path | None = None,
    report: Path | None = None,
    loads: Path | None = None,
    cut_log: Path | None = None,
    is_teaching: bool = False,
) -> AskedControl:
    """Arguments of :func:`service.control.run.control`."""
    request = ControlRequest(
        machine=machine,
        material=material,
        mode=member_of(Criterion, mode, "mode"),
        law=member_of(LawName, law, "law"),
        has_preview=has_preview,
        look_ahead=look_ahead,
        disturbances=disturbances,
        seed=seed,
        force_set_point_n=set_point,
        override_low_percent=band[0],
        override_high_percent=band[1],
        sensor=member_of(SensorChoice, sensor, "sensor"),
    )
    return request, RunFiles(
        file=file,
        code=code,
        output=output,
        report=report,
        loads=loads,
        cut_log=cut_log,
        is_teaching=is_teaching,
    )
