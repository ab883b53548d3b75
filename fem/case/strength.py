"""The floor's motion made stronger or weaker as a whole: the keys to set, by the kind of each component."""

from fem.case.case import Case
from fem.case.tables.motion_tables import FloorMotionTable


def scaled_motion(case: Case, factor: float) -> dict[str, float]:
    """The keys that multiply both components of the floor's motion by a factor; none for a floor at rest.

    The frequency of a harmonic motion stays. A recorded vertical component beside one that is scaled to a peak follows
    it anyway.
    """
    values = _scaled("motion", case.motion, factor)
    follows = case.motion.kind == case.vertical.kind == "table" and case.motion.scale_to_m_s2 is not None
    if case.has_vertical and (case.vertical.scale_to_m_s2 is not None or not follows):
        values |= _scaled("vertical", case.vertical, factor)
    return values


def _scaled(table: str, motion: FloorMotionTable, factor: float) -> dict[str, float]:
    of_a_table = "scale" if motion.scale_to_m_s2 is None else "scale_to_m_s2"
    strengths = ("amplitude_m", "peak_acceleration_m_s2")
    kinds = {"none": (), "harmonic": strengths, "pulse": strengths, "table": (of_a_table,)}
    assert motion.kind in kinds, motion.kind
    keys = kinds[motion.kind]
    given = {key: getattr(motion, key) for key in keys}
    return {f"{table}.{key}": factor * value for key, value in given.items() if value is not None}
