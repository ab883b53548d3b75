"""A site whose verification takes seconds, the least that a site file may say, and records for one."""

import json
from functools import cache

from fem.seismic.artificial import artificial_motions
from fem.seismic.ground_motion import in_whole_g, write_at2

SITE = """
container = "seed_stack"
[site]
ground = "D"
reference_acceleration_m_s2 = 3.5
[motions]
count = 3
stationary_s = 10.0
further = 2
[friction]
mu_static = [0.4]
mu_kinetic_over_static = [1.0]
[limits]
slip_m = 0.1
"""

LEAST = """
container = "seed_stack"
[site]
ground = "D"
reference_acceleration_m_s2 = 1.6
[friction]
mu_static = [0.3, 0.4]
[limits]
slip_m = 0.1
"""


@cache
def three_motions(action):
    """With both horizontal components and the vertical."""
    return artificial_motions(action, count=3, seed=5, second=1.0)


def three_records(folder, action, letters="hv", *, scale=0.5, every=1):
    """Files of three motions at 0.005 s, or of every so many samples, as a site file names them by letter."""
    names = []
    for number, motion in enumerate(three_motions(action)):
        names.append([f"r{number}_{letter}.at2" for letter in letters])
        for letter, name in zip(letters, names[-1], strict=True):
            described = f"EVENT {number}, 1/1/20, STATION {number}, {'UP' if letter == 'v' else '090'}"
            values = in_whole_g(scale * motion.lettered[letter][::every])
            write_at2(folder / name, every * motion.step, values, described)
    return json.dumps(names)
