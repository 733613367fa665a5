"""Response bodies of advice: workingsteps, feeds along the paths, and NC code."""

from pydantic import ConfigDict, Field

from service.rest.views import FindingView, View


class LimitView(View):
    """Load and bound of a limit."""

    name: str
    value: float | None
    bound: float | None
    unit: str
    sense: str
    margin: float | None = Field(description="unused share of the bound")


class SettingView(View):
    """Feed, spindle speed and depth of cut."""

    feed_mm_min: float
    spindle_rpm: float
    feed_per_tooth_mm: float
    axial_depth_mm: float
    passes: int | None = None
    plunge_feed_mm_min: float | None = Field(
        default=None, description="feed into the material; null: same as the feed of the cut"
    )
    plunge_feed_per_tooth_mm: float | None = None


class PlungeView(View):
    """Limits of the plunge feed, and its active limit."""

    reason: str
    fault: str | None = Field(description="why the tool must not plunge; null: it may")
    limits: list[LimitView]


class BeforeAfterView(View):
    """Value as programmed and as advised."""

    before: float | None
    after: float | None


class StabilityView(View):
    """Chatter stability of a cut; its bound is one of the limits."""

    basis: str = Field(description="measured, estimated (sets no bound) or not_used")
    reason: str
    stable_at_any_speed_mm: float | None
    band_mm: list[float] | None = Field(description="lower and upper value of an estimate")


class ChatterRiskView(View):
    """Depth beyond the optimistic end of an estimate of the stable depth."""

    depth_mm: float
    stable_mm: float


class UncheckedView(View):
    """Required limit that could not be looked at, or only by a stand-in."""

    name: str
    why: str
    datum: str = Field(description="what would bring the limit")


class HoldingLoadView(View):
    """Loads of a cut on the work-holding; their bounds are among the limits."""

    torque_nm: float = Field(description="about the axis of a bar, axial force included")
    moment_nm: float = Field(description="tilting moment about the jaws; 0: unknown or none")
    force_n: float = Field(description="largest force across the axis of a mill")
    lift_n: float = Field(description="largest axial force that lifts the workpiece")


class RefusedPassesView(View):
    """Number of passes that is no candidate for a workingstep."""

    passes: int
    reason: str


class AdvisedView(View):
    """Advised feed of one workingstep, with the reasons."""

    model_config = ConfigDict(extra="allow", frozen=True)

    id: str
    instance: str
    operation: str
    tool: str
    status: str
    reason: str = Field(description="what limits the feed, in a sentence")
    programmed: SettingView | None
    advised: SettingView | None
    active_limit: str | None
    limits: list[LimitView]
    motor_power_kw: float | None
    cutting_force_n: float | None
    roughness_ra_um: float | None
    roughness_basis: str | None = Field(
        default=None, description="what the roughness is: ideal, not measured"
    )
    roughness_expected_um: float | None = Field(
        default=None, description="Ra that half of real surfaces keep; null: nothing is known"
    )
    roughness_probability: float | None = Field(
        default=None, description="probability that the surface keeps its required Ra"
    )
    refused_passes: list[RefusedPassesView] = Field(
        default=[], description="numbers of passes that would leave other stock than programmed"
    )
    energy_j: float | None
    cost: float | None = Field(
        default=None,
        description="of machine time and worn edges, in the currency of the machine; "
        "null: its file has no cost table",
    )
    tool_lives_used: float | None = Field(
        default=None, description="share of a tool life that the cut takes; null: unknown"
    )
    time_s: BeforeAfterView
    stability: StabilityView | None = Field(
        default=None, description="null: chatter does not depend on the depth of this cut"
    )
    chatter_risk: ChatterRiskView | None = Field(
        default=None, description="null: no depth beyond the estimate of the stable depth"
    )
    unchecked: list[UncheckedView] = Field(
        default=[], description="required limits that could not be looked at"
    )
    plunge: PlungeView | None = Field(
        default=None, description="null: the cut has no separate plunge feed"
    )
    holding_load: HoldingLoadView | None = Field(
        default=None, description="null: no cut, or no work-holding applies"
    )


class FigureView(View):
    """Predicted value and the value found in the simulated run."""

    promised: float
    found: float
    ratio: float | None = Field(description="found over predicted")
    bound: float | None = Field(description="bound that the value must keep")
    found_at_quantile: float | None = Field(
        description="value found with the k_c at the quantile of the plan; null: the same"
    )


class StockLeftView(View):
    """Stock that a workingstep leaves, compared with that of the program as given."""

    volume_mm3: float = Field(description="volume left in addition; negative: less is left")
    deviation_mm: float = Field(
        description="greatest distance beyond the resolution of the map; 0: none"
    )


class ConfirmedView(View):
    """Predicted and found figures of one workingstep."""

    id: str
    time_s: FigureView
    cutting_force_n: FigureView
    thrust_n: FigureView
    deflection_um: FigureView
    cutting_power_w: FigureView
    drive_power_w: FigureView
    torque_nm: FigureView
    volume_cm3: FigureView
    stock_left: StockLeftView | None = Field(description="null: the stock is not known")


class ConfirmationView(View):
    """Comparison of a plan with its simulated run."""

    workingsteps: list[ConfirmedView]
    quantile: float = Field(description="quantile of k_c at which the bounds are compared")
    passed: list[str] = Field(
        description="a sentence for each bound that the run exceeded and for stock that differs"
    )


class MoveCountView(View):
    """Moves of NC code of one tool and kind."""

    tool: int | None = Field(description="number of the tool; null: before the first tool call")
    kind: str
    count: int
    length_mm: float
    least_feed_mm_min: float | None
    greatest_feed_mm_min: float | None
    advisable: int = Field(description="number of moves whose feed may be advised")
    splittable: int = Field(description="number of moves whose block may be split")


class FoundToolView(View):
    """Tool that comments of NC code describe."""

    number: int
    kind: str
    diameter_mm: float
    teeth: int
    guessed: str = Field(description="values that are guessed; empty: none")
    line: int = Field(description="line of the comment")


class CodeContentsView(View):
    """Contents and findings of NC code."""

    program: str
    control: str
    hints: list[str] = Field(description="pieces of the code that speak for the control")
    machine: str = Field(description="mill or lathe")
    units: str = Field(description="mm or inch")
    blocks: int
    executed_moves: int
    frames: list[str]
    moves: list[MoveCountView]
    tools: list[FoundToolView] = Field(description="tools that the comments describe")
    stock: str = Field(description="stock that the code states or suggests; empty: none")
    is_stock_guessed: bool
    missing: list[str] = Field(description="what optimise still needs, in words")
    command: str = Field(description="command with a name in capitals for what is missing")
    is_lossless: bool = Field(description="whether rewriting gives the file byte for byte")
    findings: list[FindingView]


class LimitShareView(View):
    """Part of a path at one active limit."""

    length_mm: float
    time_s: float


class AlongPathPartView(View):
    """Part of a program with one tool: before, and at feeds along its path."""

    id: str
    time_s: BeforeAfterView
    planned_time_s: float = Field(description="time that the plan predicts")
    bound_s: float | None = Field(description="least time of any feeds; null: none was chosen")
    feeds: int | None = Field(description="number of different feeds")
    levels_gap: float | None = Field(description="what few feeds cost, share of the time")
    gap: float | None = Field(description="time above the least time, share")
    force_n: BeforeAfterView
    thrust_n: BeforeAfterView
    deflection_um: BeforeAfterView
    drive_power_w: BeforeAfterView
    energy_j: BeforeAfterView
    volume_mm3: BeforeAfterView
    active_limits: dict[str, LimitShareView]


class SmoothestView(View):
    """Smoothest feeds of a cut within a share of time above the fastest."""

    time_s: float
    fastest_time_s: float = Field(description="time of the fastest feeds at the same places")
    unevenness_ratio: float = Field(
        description="squared changes of the acceleration over those of the fastest feeds"
    )


class FreeProfileView(View):
    """Feeds of a cut without the steps of a control, within the accelerations of the axes."""

    time_s: float
    bound_s: float = Field(description="least time of any feeds")
    jerk_limited_time_s: float | None = Field(
        description="time with limited jerk; null: not requested"
    )
    smoothest: SmoothestView | None = Field(
        description="smoothest feeds within a time budget; null: not requested"
    )
    greatest_excess: float | None = Field(description="greatest excess over a limit, share")
    greatest_excess_limit: str | None


class AlongPathView(View):
    """Feeds along the paths: both runs on the virtual machine."""

    time_s: BeforeAfterView
    planned_time_s: float
    blocks: int = Field(description="number of blocks with other feeds")
    splits: int = Field(description="number of parts added by splitting blocks")
    active_limits: dict[str, float] = Field(description="share of the path by active limit")
    parts: list[AlongPathPartView]
    free_profile: FreeProfileView


class AdviceView(View):
    """Advice for a program: feeds of its workingsteps."""

    model_config = ConfigDict(extra="allow", frozen=True)

    program: str
    mode: str
    machine: str
    material: str
    workingsteps: list[AdvisedView]
    is_checked: bool = Field(
        default=True, description="whether every required limit could be looked at"
    )
    unlikely_surfaces: list[str] = Field(
        default=[],
        description="workingsteps that keep their Ra with less than 90 % probability",
    )
    total_time_s: BeforeAfterView
    findings: list[FindingView]
    is_written: bool = Field(description="whether an optimised program was written")
    nc_control: str | None
    confirmation: ConfirmationView | None = Field(
        None, description="comparison with a simulated run; null if not requested"
    )
    along_path: AlongPathView | None = Field(
        None, description="feeds along the paths; null if not requested"
    )


class UnchangedBlockView(View):
    """Block that did not get what was advised."""

    line: int
    reason: str
    is_unsplit: bool = Field(description="whether it got one feed instead of several")


class RewrittenView(View):
    """Blocks of rewritten NC code."""

    changed: int
    added: int = Field(description="number of blocks added by splitting")
    restored: int = Field(description="number of blocks that state the programmed feed again")
    unchanged: list[UnchangedBlockView]


class CodeAdviceView(View):
    """Advice on NC code: feeds along its paths."""

    model_config = ConfigDict(extra="allow", frozen=True)

    program: str
    control: str
    machine: str
    material: str
    frame: str = Field(description="frame in which the stock stands")
    is_checked: bool = Field(
        default=True, description="whether no mill cuts deeper than its tool allows"
    )
    slower_than_programmed: list[str] = Field(
        default=[], description="why parts of the program take longer than programmed"
    )
    along_path: AlongPathView
    blocks: RewrittenView
    findings: list[FindingView]
    is_written: bool
    nc_control: str


class CurveSignalView(View):
    """Minimum and maximum of a signal in each stretch of a curve; null: unknown."""

    low: list[float | None]
    high: list[float | None]


class PathCurveView(View):
    """Signals of a run in at most 1000 stretches."""

    begin: list[float] = Field(description="beginning of each stretch, mm or s")
    end: list[float] = Field(description="end of each stretch, mm or s")
    signals: dict[str, CurveSignalView] = Field(
        description="signals by name, which states the unit"
    )


class CurvePairView(View):
    """Run at the given feeds, and run at the feeds along the paths."""

    before: PathCurveView
    after: PathCurveView


class LimitStripView(View):
    """Active limits along the path; where several hold within a stretch, the longest."""

    names: list[str]
    begin_mm: list[float]
    end_mm: list[float]
    limit: list[int] = Field(description="index of the limit in names")


class CurvesView(View):
    """Feed, force and power of both runs, in at most 2000 points a curve."""

    length_mm: CurvePairView = Field(description="by the length of the path")
    time_s: CurvePairView = Field(description="over time")
    limits: LimitStripView
