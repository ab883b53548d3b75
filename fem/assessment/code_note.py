"""The note on the rows of the code and of the wind beside a run: whose values they use, whether the method applies."""

from fem.results.run_result import StaticResult
from fem.seismic.wind import COMBINATION


def code_note(static: StaticResult) -> str:
    """The note below the rows of the code and of the wind; empty where there are none."""
    notes = []
    if static.wind is not None:
        notes.append(
            "The wind (1.5 of it, 0.9 of the weight, level floor) acts on the container as it is; check it empty, too. "
            f"{COMBINATION}"
        )
    if static.code is not None:
        notes.append(
            f"The code's rows take {_values(static)}. They are a design response (EN 1998-1:2004, 4.3.3.2), not the "
            "motion of this floor; they are not compared with the run."
        )
        if static.method_applicable is False:
            notes.append(f"The lateral force method does not apply: {_reason(static)} ({static.clause}).")
    return " ".join(notes)


def _values(static: StaticResult) -> str:
    values = static.code_values
    if values is None:
        return "the values of the case"
    return (
        f"the values of the case: a_gR = {values.ground_acceleration_m_s2:g} m/s2, "
        f"S = {values.soil_factor:g}, q = {values.behaviour_factor:g}, gamma_I = {values.importance_factor:g}, "
        f"T_C = {values.corner_period_s:g} s"
    )


def _reason(static: StaticResult) -> str:
    if static.period_eq3_s is None or static.period_limit_s is None:
        return "the rocking period is too long"
    return f"the rocking period, {static.period_eq3_s:.3g} s, is above min(4 T_C, 2 s) = {static.period_limit_s:.3g} s"
