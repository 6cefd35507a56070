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
USUAL_GOING_M = 0.28
LONGEST_TREAD_M = 0.62
"""A step that is deeper is a landing: no code's going is longer."""
STEEPEST_TREAD_DEG = 12.0
"""A surface that leans more is a piece of a ramp or of a slanting object; treads of a badly levelled scan lean less."""

# Flights.
STEEPEST_PITCH_DEG = 60.0
"""Steeper is a ladder."""
USUAL_STEEPEST_PITCH_DEG = 42.0
"""Pitch of the steepest stair whose treads are told from its risers by it: at 45 degrees both are equal."""
MOST_UNEVEN = 1.6
"""Ratio of two rises that follow each other above which they do not belong to one flight."""
MOST_UNEVEN_OF_TWO = 1.35
"""The same for two risers alone, which furniture imitates more easily than a longer flight."""
TALLEST_FOOT = 1.75
"""The same for the first riser of a long flight: above, a tread may be missing."""
LANDING_RATIO = 1.8
"""A step that is this much deeper than the others of its flight is a landing too."""
SURE_RISERS = 3
"""So many even risers in a row are a flight by themselves."""

# What the paper's height clusters must show to be called a staircase: lenient, because clusters mix surfaces.
PAPER_RISE_M = (0.06, 0.35)
PAPER_MOST_UNEVEN = 1.7
PAPER_CENTRES_M = (0.15, 0.9)
"""Distance of two centres: from the narrowest tread to half a tread and half a landing."""
PAPER_STEEPEST_TREAD_DEG = 8.0

# Around a staircase.
HEADROOM_M = 1.9
SLAB_THICKNESS_M = (0.012, 0.12)
FURNITURE_M = (0.2, 1.3)
RAMP_DEG = (2.0, 12.0)
