"""The shape of one step: its plane and its edges, in its own frame."""

from dataclasses import dataclass

import numpy as np

from stair_inspector.geometry.arrays import Floats
from stair_inspector.geometry.block_scatter import BlockScatter
from stair_inspector.geometry.edges import EdgeLine
from stair_inspector.geometry.plan import left_of, place_in_frame


@dataclass(frozen=True, slots=True, eq=False)
class LocalPlane:
    """Height over a step's frame, ``z0_m + slope[0] * s + slope[1] * w``, with the covariance of the three numbers.

    ``covariance`` (3, 3) comes from the scatter of the means of blocks, so that noise which is the same over a whole
    block counts as it must; ``sigma_m`` is the noise of single points, ``spacing_m`` their distance, ``misfit_m`` how
    far the surface itself departs from the plane, beyond what noise explains; ``layers_m`` how far apart two layers of
    points lie that cover the same places, 0 where there is one. ``cover_m`` is by how much a strip of carpet on the
    surface leaves its height and its edges uncertain, and ``aside_m`` its width, as a shift between stations does.
    """

    z0_m: float
    slope: tuple[float, float]
    covariance: Floats
    sigma_m: float
    spacing_m: float
    misfit_m: float
    n_points: int
    layers_m: float = 0.0
    cover_m: float = 0.0
    aside_m: float = 0.0

    def at(self, s_m: float, w_m: float) -> float:
        """Return the height at a place of the step's frame, metres."""
        return self.z0_m + self.slope[0] * s_m + self.slope[1] * w_m

    def noise_at(self, s_m: float, w_m: float) -> float:
        """Return the standard uncertainty of :meth:`at`, metres."""
        place = np.array([1.0, s_m, w_m])
        return float(np.sqrt(max(0.0, place @ self.covariance @ place)))


@dataclass(frozen=True, slots=True, eq=False)
class Arc:
    """The middle line of a flight that curves: an arc about ``centre_m`` (2,), plan of the level frame, metres.

    ``sense`` is 1 where the flight turns to the left, -1 to the right. ``radius_noise_m`` is the standard uncertainty
    of the radius, ``middle_noise_m`` that of the place of the middle line between the sides.
    """

    centre_m: Floats
    radius_m: float
    sense: float
    radius_noise_m: float
    middle_noise_m: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class StepShape:
    """The plane and the edges of one step in its own frame, metres.

    The frame lies level at ``origin_m`` (2,) of the plan; ``s`` runs along ``climb`` (2,), ``w`` to its left. ``front``
    and ``back`` give s as a function of w, ``left`` and ``right`` w as a function of s. ``extent`` is (s_low, s_high,
    w_low, w_high) of what was seen of the surface. ``foot`` is the floor or landing in front of the lowest step.
    ``back_limits`` are the bounds of a back edge that is hidden. ``line_range`` is the range (w_right, w_left) at the
    nosing over which the measuring lines are laid: the step's own sides, or those of its flight where the step is a
    wide landing or a side of it is hidden. ``nosing_offsets`` and ``nosing_noise`` are the height of the surface at the
    nosing above its plane, and its standard uncertainty, on the left, centre and right line: a nosing strip stands
    proud, a worn tread is deepest in its middle. ``arc`` is
    that of the whole flight where it curves: then ``climb`` runs along it. ``scatter`` is how heights scatter within
    small blocks of the surface, None where too little of it is known or something lies on it.
    """

    surface: int
    origin_m: Floats
    climb: Floats
    plane: LocalPlane
    extent: tuple[float, float, float, float]
    front: EdgeLine
    back: EdgeLine | None
    left: EdgeLine
    right: EdgeLine
    foot: LocalPlane | None
    back_limits: tuple[float, float] | None
    coverage: float
    line_range: tuple[float, float]
    nosing_offsets: tuple[float, float, float]
    nosing_noise: tuple[float, float, float]
    arc: Arc | None = None
    scatter: BlockScatter | None = None

    def to_plan(self, s_m: float, w_m: float) -> Floats:
        """Return a place of this frame in plan coordinates of the level frame, (2,)."""
        left = left_of(self.climb)
        plan: Floats = self.origin_m + s_m * self.climb + w_m * left
        return plan

    def from_plan(self, plan: Floats) -> tuple[float, float]:
        """Return a place of the plan in this frame: s and w."""
        return place_in_frame(plan, self.origin_m, self.climb)
