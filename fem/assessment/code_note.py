"""The note on the code's rows beside a run: whose values they use, and whether the method applies."""

from fem.results.run_result import StaticResult


def code_note(static: StaticResult) -> str:
    """The note below the code's rows; empty where there are none."""
    if static.code is None:
        return ""
    note = (
        f"The code's rows take {_values(static)}. They are a design response (EN 1998-1:2004, 4.3.3.2), not the motion "
        "of this floor; they are not compared with the run."
    )
    if static.method_applicable is not False:
        return note
    return f"{note} The lateral force method does not apply: {_reason(static)} ({static.clause})."


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
