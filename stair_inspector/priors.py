"""What is a staircase? Every figure about staircases as they are built, once: all rooms read it here and nowhere else.

Lengths in metres, angles in degrees. These are no limits of building codes (those are rule files): a bad staircase is
what an inspector looks for, so they say only what cannot be a staircase, or what is most often one. A limit that the
user can widen is a setting (``flights.*``); its default is here.
"""

# Steps.
LEAST_RISE_M, MOST_RISE_M = 0.06, 0.3
"""Rises that are looked for by default; codes allow 100 to 241 mm."""
SHORTEST_GOING_M = 0.1
"""From nosing to nosing; alternating treads and ladders are none."""
USUAL_RISE_M, USUAL_GOING_M = 0.17, 0.28
USUAL_STRIDE_M, STRIDE_SPREAD = 0.62, 0.2
"""Two rises and a going, which are about one stride on all stairs, and the scatter of its logarithm."""
COMMON_RISES_M = (0.1, 0.24)
"""Rises that are built; a rise beyond by ``RISE_SPREAD_M`` is rare."""
RISE_SPREAD_M = 0.06
LONGEST_TREAD_M = 0.62
"""A step that is deeper is a landing: no code's going is longer."""
STEEPEST_TREAD_DEG = 12.0
"""A surface that leans more is a piece of a ramp or of a slanting object; treads of a badly levelled scan lean less."""

FLOOR_STRIP_M = 0.6
"""Of a floor or landing only so much at the stair counts, beyond it may lean otherwise: less than the longest tread."""
NARROWEST_TREAD_M = 0.1
"""A surface that is narrower is a railing, a ledge or a beam."""
SMALLEST_TREAD_M2 = 0.03
"""Default of what is looked for: of a tread only a part may be seen."""
DEEPEST_OVERHANG_M = 0.06
"""How far a nosing stands over the tread below at most; what lies farther under it is another surface."""
RISER_AHEAD_M, RISER_BEHIND_M = 0.02, 0.09
"""Between these, before and behind the nosing above it, lies a riser's face: inclined and recessed risers included."""
NOSING_THICKNESS_M = 0.05
"""So much below a nosing its own front may stand before the riser."""
WIDEST_BAR_M, USUAL_BAR_M, WIDEST_BAR_GAP_M = 0.15, 0.06, 0.105
"""Treads of bars, as gratings and planks: a wider piece is no bar, two of them side by side are two surfaces."""
RUNNER_THICKNESS_M = (0.004, 0.03)
"""Between these, a strip on a tread is a runner of carpet and no unevenness, and no other tread."""
USUAL_WIDTH_M = 1.0

# Flights.
STEEPEST_PITCH_DEG = 60.0
"""Steeper is a ladder."""
USUAL_STEEPEST_PITCH_DEG = 42.0
"""Pitch of the steepest stair whose treads are told from its risers by it: at 45 degrees both are equal."""
USUAL_PITCH_DEG, PITCH_SPREAD_DEG = 32.0, 7.0
"""Pitch of the stairs that are built, and how far they scatter about it."""
MOST_UNEVEN = 1.6
"""Ratio of two rises that follow each other above which they do not belong to one flight."""
MOST_UNEVEN_OF_TWO = 1.35
"""The same for two risers alone, which furniture imitates more easily than a longer flight."""
TALLEST_FOOT = 1.75
"""The same for the first riser of a long flight: above, a tread may be missing."""
LANDING_RATIO = 1.8
"""A step that is this much deeper than the others of its flight is a landing too."""
MOST_TURN_DEG = 45.0
"""Turn from one step to the next, as of the wedges of a tight spiral."""
WINDING_TURN_DEG = 8.0
"""A flight winds where its direction turns by more from step to step; the edges of patches are that uncertain."""
SPIRAL_DEG = 120.0
"""A flight that turns by more in all, always the same way, is a spiral; by less, winders."""
STRAIGHT_ON_DEG = 10.0
"""Flights whose directions differ by less go straight on over the landing between them: a limit between flights, of
which each has several edges; between two single edges of patches it is ``pace.SAME_CLIMB_DEG``."""
SHORTEST_EDGE_M = 0.2
"""Two treads that touch along a shorter edge do not follow each other by that alone."""
NARROWEST_FLIGHT_M = 0.56
"""Codes allow no narrower flight; one that is twice as wide may be two side by side."""
NARROWEST_OF_TWO_M, SHALLOWEST_OF_TWO_M = 0.45, 0.15
"""Width and depth of two risers that are a flight by themselves: boxes are smaller."""
FLOOR_RATIO = 2.2
"""A surface this much larger than the one above it is a floor or landing, from which a flight may begin anywhere."""
TIGHTEST_CURVE_M = 1.5
"""Radius of the middle line of a curved flight; a flight that turns about a nearer centre is a spiral or winds."""
SURE_RISERS = 3
"""So many even risers in a row are a flight by themselves."""

# How exactly staircases are built: standard deviations of a good one, beyond what was measured of it.
BUILT_OVERHANG_M, BUILT_GOING_M = 0.0015, 0.004
"""Of overhangs and of goings from step to step."""
BUILT_PARALLEL_DEG = 0.25
"""How parallel the nosings of a straight flight are at least."""
BUILT_LEVEL_DEG = 0.1
"""How level treads are on the whole, where no floor says whether they are."""
UNLEVEL_DEG = 0.3
"""Three of these: floors and treads that lean by less are built so, by some millimetres in a metre."""

# What the paper's height clusters must show to be called a staircase: lenient, because clusters mix surfaces.
PAPER_RISE_M = (0.06, 0.35)
PAPER_MOST_UNEVEN = 1.7
PAPER_CENTRES_M = (0.15, 0.9)
"""Distance of two centres: from the narrowest tread to half a tread and half a landing."""
PAPER_STEEPEST_TREAD_DEG = 8.0

# Around a staircase.
SMALLEST_SCAN_M, USUAL_SCAN_M, LARGEST_SCAN_M = 0.8, 8.0, 300.0
"""Sizes of scans in which a staircase may be: the diagonal without stray points."""
HEADROOM_M = 1.9
SLAB_THICKNESS_M = (0.012, 0.12)
DEEPEST_BELOW_M = 0.6
"""What lies less than this under a step is the underside of its slab, or stands below the stairs."""
FURNITURE_M = (0.2, 1.3)
TALLEST_TIER_M, DEEPEST_TIER_M, NARROWEST_TIERS_M = 0.6, 1.2, 4.0
"""Tiers of seats and terraces are steeper or deeper than stairs, up to this, and wider."""
RAMP_DEG = (2.0, 12.0)
