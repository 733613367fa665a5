"""Enumerations of ISO 14649-10, -11, -111, -12, -121 and ISO 10303-42.

The value of a member is the EXPRESS name in upper case, as a Part 21 file writes it between
dots.
"""

from enum import StrEnum


class Logical(StrEnum):
    """EXPRESS type LOGICAL, with the third value unknown."""

    TRUE = "T"
    FALSE = "F"
    UNKNOWN = "U"


class ToolReferencePoint(StrEnum):
    """Reference point on the tool for the programmed feed."""

    TCP = "TCP"
    CCP = "CCP"


class Hand(StrEnum):
    """Hand of cut of a rotating tool."""

    LEFT = "LEFT"
    RIGHT = "RIGHT"
    NEUTRAL = "NEUTRAL"


class RotDirection(StrEnum):
    """Direction of rotation in which a contour is followed."""

    CW = "CW"
    CCW = "CCW"


class CutmodeType(StrEnum):
    """Cut mode: climb (down) or conventional (up) milling."""

    CLIMB = "CLIMB"
    CONVENTIONAL = "CONVENTIONAL"


class LeftOrRight(StrEnum):
    """Side to which strokes step over."""

    LEFT = "LEFT"
    RIGHT = "RIGHT"


class PathmodeType(StrEnum):
    """Strokes in one direction or in both."""

    FORWARD = "FORWARD"
    ZIGZAG = "ZIGZAG"


class StrokeConnectionStrategy(StrEnum):
    """Move from the end of one stroke to the start of the next."""

    STRAGHTLINE = "STRAGHTLINE"
    """spelt so in ISO 14649-11"""
    STRAIGHTLINE = "STRAIGHTLINE"
    """spelt so in files"""
    LIFT_SHIFT_PLUNGE = "LIFT_SHIFT_PLUNGE"
    DEGOUGE = "DEGOUGE"
    LOOP_BACK = "LOOP_BACK"


class ToolpathType(StrEnum):
    """Purpose of a tool path."""

    APPROACH = "APPROACH"
    LIFT = "LIFT"
    CONNECT = "CONNECT"
    NON_CONTACT = "NON_CONTACT"
    CONTACT = "CONTACT"
    TRAJECTORY_PATH = "TRAJECTORY_PATH"


class SpeedName(StrEnum):
    """Named feed, used instead of a number."""

    RAPID = "RAPID"


class ContactType(StrEnum):
    """Part of the cutter that touches the surface."""

    SIDE = "SIDE"
    FRONT = "FRONT"


class BottomOrSide(StrEnum):
    """Part of a feature to which a surface finish applies."""

    BOTTOM = "BOTTOM"
    SIDE = "SIDE"
    BOTTOM_AND_SIDE = "BOTTOM_AND_SIDE"


class FittingType(StrEnum):
    """Partner of a fit: shaft or hole."""

    SHAFT = "SHAFT"
    HOLE = "HOLE"


class CoolantSelect(StrEnum):
    """Coolant selection of a lathe (ISO 14649-12)."""

    FLOOD = "FLOOD"
    MIST = "MIST"
    THROUGH_TOOL = "THROUGH_TOOL"


class ThreadCutDepthType(StrEnum):
    """Progression of the depth of thread passes (ISO 14649-12)."""

    CONSTANT_DEPTH = "CONSTANT_DEPTH"
    VARIABLE_DEPTH = "VARIABLE_DEPTH"
    CONSTANT_REMOVAL_AMOUNT = "CONSTANT_REMOVAL_AMOUNT"


class ThreadingDirectionType(StrEnum):
    """Flank along which a threading tool is fed (ISO 14649-12)."""

    LEFT = "LEFT"
    RIGHT = "RIGHT"
    CENTER = "CENTER"
    LEFT_ZIGZAG = "LEFT_ZIGZAG"
    RIGHT_ZIGZAG = "RIGHT_ZIGZAG"


class HandOfToolType(StrEnum):
    """Hand of a turning tool (ISO 14649-121)."""

    LEFT = "LEFT"
    RIGHT = "RIGHT"
    NEUTRAL = "NEUTRAL"


class ThreadHandType(StrEnum):
    """Hand of the thread that a tool cuts (ISO 14649-121)."""

    LEFT = "LEFT"
    RIGHT = "RIGHT"


class ThreadType(StrEnum):
    """Internal or external thread (ISO 14649-121)."""

    INTERNAL = "INTERNAL"
    EXTERNAL = "EXTERNAL"


class ThreadProfileType(StrEnum):
    """Threading insert with a full or partial profile (ISO 14649-121)."""

    FULL_PROFILE = "FULL_PROFILE"
    PARTIAL_PROFILE = "PARTIAL_PROFILE"


class KnurlPatternType(StrEnum):
    """Pattern of a knurling wheel, named after the knurls of ISO 14649-12."""

    STRAIGHT = "STRAIGHT"
    DIAGONAL = "DIAGONAL"
    DIAMOND = "DIAMOND"


class TransitionCode(StrEnum):
    """Continuity between one segment of a composite curve and the next (ISO 10303-42)."""

    DISCONTINUOUS = "DISCONTINUOUS"
    CONTINUOUS = "CONTINUOUS"
    CONT_SAME_GRADIENT = "CONT_SAME_GRADIENT"
    CONT_SAME_GRADIENT_SAME_CURVATURE = "CONT_SAME_GRADIENT_SAME_CURVATURE"


class TrimmingPreference(StrEnum):
    """Preferred way of trimming a curve if both are given (ISO 10303-42)."""

    CARTESIAN = "CARTESIAN"
    PARAMETER = "PARAMETER"
    UNSPECIFIED = "UNSPECIFIED"


class BSplineCurveForm(StrEnum):
    """Kind of curve that a B-spline represents (ISO 10303-42)."""

    POLYLINE_FORM = "POLYLINE_FORM"
    CIRCULAR_ARC = "CIRCULAR_ARC"
    ELLIPTIC_ARC = "ELLIPTIC_ARC"
    PARABOLIC_ARC = "PARABOLIC_ARC"
    HYPERBOLIC_ARC = "HYPERBOLIC_ARC"
    UNSPECIFIED = "UNSPECIFIED"


class KnotType(StrEnum):
    """Distribution of the knots of a B-spline (ISO 10303-42)."""

    UNIFORM_KNOTS = "UNIFORM_KNOTS"
    QUASI_UNIFORM_KNOTS = "QUASI_UNIFORM_KNOTS"
    PIECEWISE_BEZIER_KNOTS = "PIECEWISE_BEZIER_KNOTS"
    UNSPECIFIED = "UNSPECIFIED"


class AheadOrBehind(StrEnum):
    """Sign of an offset from universal time (ISO 10303-41)."""

    AHEAD = "AHEAD"
    EXACT = "EXACT"
    BEHIND = "BEHIND"
