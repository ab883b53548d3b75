"""The floor's motion made stronger or weaker as a whole: the keys to set, by the kind of each component."""

from fem.case.case import Case


def scaled_motion(case: Case, factor: float) -> dict[str, float]:
    """The keys that multiply both components of the floor's motion by a factor; none for a floor at rest.

    The frequency of a harmonic motion stays. A recorded vertical component beside one that is scaled to a peak follows
    it anyway.
    """
    follows = case.motion.kind == case.vertical.kind == "table" and case.motion.scale_to_m_s2 is not None
    strengths, values = ("amplitude_m", "peak_acceleration_m_s2"), {}
    for table, motion in (("motion", case.motion), ("vertical", case.vertical)):
        of_a_table = "scale" if motion.scale_to_m_s2 is None else "scale_to_m_s2"
        kinds = {"none": (), "harmonic": strengths, "pulse": strengths, "table": (of_a_table,)}
        for key in kinds[motion.kind]:
            value = getattr(motion, key)
            if value is not None and not (table == "vertical" and follows and key == "scale"):
                values[f"{table}.{key}"] = factor * value
    return values
