"""What can be asked of the simulator: the staircase, the scanner, and scanners that exist. Imports nothing heavy.

Steps are counted from the bottom: step k is the level that is reached over riser k, so ``n_risers`` risers make the
treads 1 to ``n_risers - 1`` and the upper landing ``n_risers``; level 0 is the floor.
"""

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from typing_extensions import Doc

from stair_inspector.declarations import DEGREES, METRES, MM, Group, Knob
from stair_inspector.errors import ConfigError
from stair_inspector.simulation.spec_texts import parse_errors, parse_offset, parse_steps

WallSides = Literal["none", "left", "right", "both"]
Shape = Literal["straight", "curved", "winder", "spiral"]
Turn = Literal["none", "left", "right", "u_left", "u_right"]
SLAB_M = 0.04
"""Thickness of a tread's slab, metres: the height of the nosing's upright face."""
_SMALLEST_RISE_M = 0.06
_SMALLEST_GOING_M = 0.1
_LARGEST_SKEW_M = 0.05
N_WINDERS = 3
"""Winder treads in the square in which a winder staircase turns by 90 degrees."""


@dataclass(frozen=True)
class Stair(Group):
    """A staircase and what stands around it."""

    n_risers: Annotated[
        int, Knob("risers", 1, 60, 1).says("Risers {range}; the last one leads onto the upper landing.")
    ] = 10
    rise_m: Annotated[
        float, Knob("rise", _SMALLEST_RISE_M, 0.4, 0.001, MM).says("Rise: vertical, nosing to nosing, {range}.")
    ] = 0.17
    going_m: Annotated[
        float, Knob("going", _SMALLEST_GOING_M, 1.5, 0.001, MM).says("Going: horizontal, nosing to nosing, {range}.")
    ] = 0.28
    width_m: Annotated[
        float, Knob("width", 0.3, 6.0, 0.01, MM).says("Width between the side edges of the treads, {range}.")
    ] = 1.2
    overhang_m: Annotated[
        float,
        Knob("nosing overhang", 0.0, 0.08, 0.001, MM).says(
            "How far a nosing projects past the riser below it, {range}."
        ),
    ] = 0.025
    open_risers: Annotated[bool, Doc("Leave the risers out, so that one sees through between the treads.")] = False
    landing_after: Annotated[
        int,
        Knob("landing at step", 0, 59, 1).says(
            "Step that is an intermediate landing, counted in risers from the floor (below n_risers); 0 for none."
        ),
    ] = 0
    landing_depth_m: Annotated[
        float,
        Knob("landing depth", 0.5, 5.0, 0.01, MM).says(
            "Intermediate landing, from its nosing to the nosing of the next step, {range}."
        ),
    ] = 1.2
    turn: Annotated[
        Turn,
        Doc(
            "Turn at the intermediate landing, as seen when climbing: none, left, right (by 90 degrees; the landing is "
            "a square), u_left, u_right (back beside the first flight). A curved stair, winder or spiral turns "
            "left, unless 'right' is given."
        ),
    ] = "none"
    well_m: Annotated[
        float,
        Knob("well", 0.0, 3.0, 0.01, MM).says("Gap between the two flights of a turn u_left or u_right, {range}."),
    ] = 0.1
    shape: Annotated[
        Shape,
        Doc(
            "straight; curved: all treads turn about a far centre, their going measured along the arc through the "
            "middles of the nosings; winder: three wedge treads turn the stair by 90 degrees about a post; spiral: "
            "wedge treads about a column, their going measured at the middle of the width."
        ),
    ] = "straight"
    winder_after: Annotated[
        int,
        Knob("winders after step", 0, 56, 1).says("Straight steps below the three wedge treads of a winder {range}."),
    ] = 3
    spiral_radius_m: Annotated[
        float,
        Knob("column radius", 0.03, 1.0, 0.01, MM).says(
            "Radius of a spiral's column, where its treads begin, {range}."
        ),
    ] = 0.1
    curve_radius_m: Annotated[
        float,
        Knob("radius of a curve", 1.0, 100.0, 0.1, METRES).says(
            "Radius of a curved stair, of the arc through the middles of its risers, {range}."
        ),
    ] = 4.0
    twin_gap_m: Annotated[
        float,
        Knob("gap to a twin", 0.0, 3.0, 0.01, MM).says(
            "Gap to a second staircase of the same kind on the left of the first, {range}; 0 for none."
        ),
    ] = 0.0
    upper_landing_m: Annotated[
        float,
        Knob("upper landing", 0.3, 5.0, 0.01, MM).says("Upper landing, from its nosing to its back edge, {range}."),
    ] = 1.2
    floor_front_m: Annotated[
        float, Knob("floor in front", 0.5, 10.0, 0.1, METRES).says("Floor in front of the first riser, {range}.")
    ] = 1.8
    floor_width_m: Annotated[
        float,
        Knob("floor width", 0.5, 12.0, 0.1, METRES).says(
            "Width of the floor, {range}; walls stand at the sides of the stair all the same."
        ),
    ] = 2.0
    floor_all_round: Annotated[
        bool,
        Doc("Floor on all sides of the stair, not in front only; a stair that turns or has a twin has it anyway."),
    ] = False
    strip_proud_m: Annotated[
        float,
        Knob("strip proud", 0.0, 0.01, 0.0005, MM).says(
            "How far the nosing strips, 50 mm wide, stand proud of the treads, {range}. Rises and heights are "
            "those of the strips; the treads lie this much lower."
        ),
    ] = 0.0
    round_nosing_m: Annotated[
        float,
        Knob("nosing radius", 0.0, 0.03, 0.001, MM).says(
            "Radius of the rounded edge of every nosing, {range}. The true nosing stays where the tread's "
            "plane meets the upright at the front of it."
        ),
    ] = 0.0
    missing_treads: Annotated[
        str, Doc("Treads that are not built, as steps (5,6); needs open_risers. Steps are counted as if they were.")
    ] = ""
    wall: Annotated[WallSides, Doc("Side walls, flush with the treads: none, left, right (when climbing) or both.")] = (
        "none"
    )
    ceiling: Annotated[bool, Doc("A level ceiling over everything.")] = False
    headroom_m: Annotated[
        float,
        Knob("headroom", 1.9, 5.0, 0.05, METRES).says("Ceiling, or top of a wall, above the upper landing, {range}."),
    ] = 2.3
    clutter: Annotated[
        bool, Doc("A table and two boxes on the floor, a box on a tread, and a handrail with its posts.")
    ] = False
    rise_errors_m: Annotated[
        str,
        Doc("Risers that differ, as step:metres (5:+0.015); all steps above move too. 5:0.015,6:-0.015 moves one."),
    ] = ""
    going_errors_m: Annotated[str, Doc("Goings that differ, as step:metres (3:-0.01); all steps above move too.")] = ""
    fall_errors_deg: Annotated[
        str, Doc("Treads that fall towards their nosing, as step:degrees (4:3.4); the nosing keeps its height.")
    ] = ""
    cross_fall_errors_deg: Annotated[
        str, Doc("Treads that are higher on the left, as step:degrees (4:1); the middle keeps its height.")
    ] = ""
    dish_errors_m: Annotated[
        str, Doc("Treads that are worn hollow, as step:metres at the deepest point (2:0.005); the edges stay.")
    ] = ""
    wear_errors_m: Annotated[
        str,
        Doc(
            "Nosings that are worn, as step:metres (4:0.003): a strip 50 mm deep lies this much lower than the rest of "
            "its tread. Not together with strips proud, rounded nosings or a dish."
        ),
    ] = ""
    skew_errors_m: Annotated[
        str,
        Doc(
            "Nosings that are turned in plan, as step:metres (4:0.01): the left end lies this much farther forward, "
            "towards who climbs, than the right end; the middle keeps its place. Straight stairs only."
        ),
    ] = ""
    yaw_deg: Annotated[
        float,
        Knob("yaw", -180.0, 180.0, 1.0, DEGREES).says(
            "Turn of the whole site about the vertical, {range}; 0 climbs along +x."
        ),
    ] = 0.0
    offset_m: Annotated[
        str, Doc("Where the foot of the stair lies in the output, as x,y,z in metres (691000,5335000,520).")
    ] = "0,0,0"

    def __post_init__(self) -> None:
        super().__post_init__()
        parse_offset(self.offset_m)
        if self.landing_after >= self.n_risers and self.landing_after:
            raise ConfigError(
                f"stair.landing_after: got {self.landing_after} with {self.n_risers} risers; give a step below the "
                "upper landing, or 0 for no landing"
            )
        last = self.n_risers
        rises = parse_errors("stair.rise_errors_m", self.rise_errors_m, last, 0.3)
        goings = parse_errors("stair.going_errors_m", self.going_errors_m, last - 1, 1.0)
        parse_errors("stair.fall_errors_deg", self.fall_errors_deg, last, 10.0)
        parse_errors("stair.cross_fall_errors_deg", self.cross_fall_errors_deg, last, 5.0)
        parse_errors("stair.dish_errors_m", self.dish_errors_m, last, SLAB_M / 2.0)
        self._check_wear()
        parse_errors("stair.skew_errors_m", self.skew_errors_m, last, _LARGEST_SKEW_M)
        self._check_missing()
        self._check_turn()
        self._check_wedges()
        self._check_straight_only()
        for name, wanted, errors, smallest in (
            ("rise", self.rise_m, rises, _SMALLEST_RISE_M),
            ("going", self.going_m, goings, _SMALLEST_GOING_M),
        ):
            for step, error in errors.items():
                if not wanted + error >= smallest:
                    raise ConfigError(
                        f"stair.{name}_errors_m: step {step} would have a {name} of {wanted + error:g} m; give an "
                        f"error that leaves at least {smallest:g} m"
                    )

    @property
    def is_turning(self) -> bool:
        """Whether one leaves the stair in another direction than one enters it, or beside the way one came."""
        return self.turn != "none" or self.shape != "straight"

    def _check_wear(self) -> None:
        worn = parse_errors("stair.wear_errors_m", self.wear_errors_m, self.n_risers, SLAB_M / 2.0)
        if any(depth < 0.0 for depth in worn.values()):
            raise ConfigError(f"stair.wear_errors_m: got {self.wear_errors_m!r}; give depths, which are not negative")
        others = {
            "strip_proud_m": self.strip_proud_m > 0.0,
            "round_nosing_m": self.round_nosing_m > 0.0,
            "dish_errors_m": bool(self.dish_errors_m.strip()),
        }
        for name, is_set in others.items():
            if worn and is_set:
                raise ConfigError(f"stair.wear_errors_m: not possible with {name}; leave one of them out")

    def _check_missing(self) -> None:
        steps = parse_steps("stair.missing_treads", self.missing_treads, self.n_risers - 1)
        if steps and not self.open_risers:
            raise ConfigError("stair.missing_treads: a tread can be missing only where open_risers is on")
        if self.landing_after in steps:
            raise ConfigError(f"stair.missing_treads: step {self.landing_after} is a landing; give treads")

    def _check_turn(self) -> None:
        if self.shape == "straight" and self.turn != "none" and not self.landing_after:
            raise ConfigError(f"stair.turn: got {self.turn!r} without a landing; give landing_after, or shape winder")
        if self.shape != "straight" and self.turn.startswith("u_"):
            raise ConfigError(f"stair.turn: got {self.turn!r} with shape {self.shape}; give left or right")
        if self.turn != "none" and self.shape == "straight":
            for name in ("going_errors_m", "dish_errors_m"):
                if self.landing_after in parse_errors(f"stair.{name}", getattr(self, name), self.n_risers, math.inf):
                    raise ConfigError(f"stair.{name}: step {self.landing_after} is a landing that turns; give a tread")

    def _check_wedges(self) -> None:
        if self.shape == "winder" and self.winder_after + N_WINDERS >= self.n_risers:
            raise ConfigError(
                f"stair.winder_after: got {self.winder_after} with {self.n_risers} risers; give at most "
                f"{self.n_risers - N_WINDERS - 1}, and at least {N_WINDERS + 1} risers"
            )
        if self.shape == "spiral" and self.going_m > self.spiral_radius_m + self.width_m / 2.0:
            raise ConfigError(
                f"stair.going_m: got {self.going_m:g}; a spiral of this width has room for "
                f"{self.spiral_radius_m + self.width_m / 2.0:g} m at most"
            )

        if self.shape == "curved" and self.curve_radius_m <= self.width_m:
            raise ConfigError(
                f"stair.curve_radius_m: got {self.curve_radius_m:g} with a width of {self.width_m:g} m; give more than "
                "the width, or shape spiral"
            )

    def _check_straight_only(self) -> None:
        straight_only = {
            "landing_after": self.shape != "straight" and self.landing_after > 0,
            "going_errors_m": self.shape != "straight" and bool(self.going_errors_m.strip()),
            "skew_errors_m": self.shape != "straight" and bool(self.skew_errors_m.strip()),
            "dish_errors_m": self.shape != "straight" and bool(self.dish_errors_m.strip()),
            "wall": self.is_turning and self.wall != "none",
            "twin_gap_m": self.is_turning and self.twin_gap_m > 0.0,
        }
        for name, is_set in straight_only.items():
            if is_set:
                what = f"shape {self.shape}" if self.shape != "straight" else f"turn {self.turn}"
                raise ConfigError(f"stair.{name}: got {getattr(self, name)!r}; not possible with {what}")
