"""The modes of motion, and from where on a motion counts as one; without any kernel."""

#: rotation ratio above which motion with an open side is rocking
ROCKING = 0.01

#: path over the width that counts as sliding, and gap of a whole base over the width that counts as a hop
SLIDING = HOPPING = 1e-4
LEAST_SLIDE = 1e-3  #: .. and that path at least [m]

#: modes of motion as stored in a history, and as bits in `modes`
REST, SLIDE, ROCK, SLIDE_ROCK, FALLEN = 0, 1, 2, 3, 4
HOP = 5  #: an outcome alone: see `max_flight`
