"""Whether a motion can be that of a floor, whatever its source: interval, displacement, mean, signs and peak.

What no floor does is refused, with the slip that is likely behind it; what is unusual is a note.
"""

import numpy as np

from fem.records.processing import motion_of
from fem.records.record import Component, RecordError
from fem.records.units import STANDARD_GRAVITY, TIMES, UNITS

STEPS = (0.0005, 0.1)  #: usual intervals of samples [s]
#: displacements of a floor that are doubtful, and that are refused; a fault moves the ground by 10 m [m]
FAR, TOO_FAR = 5.0, 100.0
#: of accelerations of one sign, which push the floor away for as long as they last [m]
TOO_FAR_ONE_WAY = 10.0
LOPSIDED = 0.3  #: mean of the acceleration over its peak from which it is doubtful
LEAST_SAMPLES = 20  #: from which mean and signs say something; a pulse is given by fewer
#: peaks of a motion that moves a container and is not beyond almost all records, and peaks that no record reaches,
#: where only the case states the unit and where the file does [m/s2]
USUAL_PEAKS = (0.5, 20.0)
MOST_PEAK, MOST_STATED_PEAK = 30.0, 60.0


def doubts(name: str, component: Component, made: Component, *, scale: float, confirmed: bool) -> list[str]:
    """What is unusual about a motion, in sentences; RecordError: no floor moves so.

    Args:
        name: of the record.
        component: as its file has it, or the part taken of it.
        made: as the floor follows it.
        scale: the factor in it.
        confirmed: its peak is given.
    """
    x, _, followed = motion_of(made)
    notes, step = [], component.step
    if not STEPS[0] * (1.0 - 1e-6) <= step <= STEPS[1] * (1.0 + 1e-6):
        unusual = f"its samples are {step:.4g} s apart, and those of records {STEPS[0]:g} to {STEPS[1]:g} s"
        if not component.time_stated:
            fitting = (
                f" (it would be {step * factor:.4g} s if its times are in {unit})"
                for unit, factor in TIMES.items()
                if STEPS[0] <= step * factor <= STEPS[1]
            )
            meant = next(fitting, "")
            raise RecordError(
                f"{name}: {unusual}{meant}; the file does not state the unit of its times: write it into "
                "a line above the numbers, such as 't [s]' or 't [ms]', or correct the times"
            )
        notes.append(unusual)
    if not confirmed:
        notes += _of_peak(name, component, float(np.abs(followed).max()), scale)
    a, far, limit = component.values, float(np.abs(x - x[0]).max()), TOO_FAR
    sign = ""
    if component.quantity == "acceleration" and a.size >= LEAST_SAMPLES:
        peak, mean = float(np.abs(a).max()), float(np.mean(a))
        if peak > 0.0 and (float(a.min()) >= 0.0 or float(a.max()) <= 0.0):
            sign, limit = "its accelerations have one sign", TOO_FAR_ONE_WAY
        elif abs(mean) > LOPSIDED * peak:
            sign = f"the mean of its accelerations is {abs(mean) / peak:.0%} of their peak"
            limit = TOO_FAR_ONE_WAY
    if far > limit:
        lead = f"{sign}, and " if sign else ""
        raise RecordError(
            f"{name}: {lead}the floor would move {far:.3g} m, and no floor does; is it a spectrum, "
            "is gravity or an offset in it, are its times in another unit, or does it need baseline = "
            '"mean" or "linear"?'
        )
    if sign:
        notes.append(sign)
    if far > FAR:
        notes.append(
            f"it moves the floor by {far:.3g} m; is a baseline needed, or a unit or the times wrong?"
        )
    return notes


def _of_peak(name: str, component: Component, peak: float, scale: float) -> list[str]:
    unscaled = peak / abs(scale) if scale else 0.0
    limit = MOST_STATED_PEAK if component.unit_stated else MOST_PEAK
    number = unscaled / abs(component.factor)
    # the peak if the values were of another unit that makes it a usual one
    usual = [
        f"{number * UNITS[unit].factor:.3g} m/s2 if the values were {unit}"
        for unit in ("g", "m/s2", "gal", "mm/s2")
        if component.quantity == "acceleration"
        and UNITS[unit].factor != abs(component.factor)
        and USUAL_PEAKS[0] <= number * UNITS[unit].factor <= USUAL_PEAKS[1]
    ]
    other_units = f" (it would be {' or '.join(usual)})" if usual else ""
    if min(peak, unscaled) > limit:
        source = "the unit that the file states," if component.unit_stated else "unit ="
        raise RecordError(
            f"{name}: its accelerations reach {unscaled:.4g} m/s2 with {source} {component.unit!r}, and hardly any "
            f"record reaches {limit:g} m/s2, {limit / 10.0:g} g{other_units}; is the unit right? "
            f"If they are meant, say so: scale_to_m_s2 = {peak:.4g}"
        )
    if USUAL_PEAKS[0] <= peak <= USUAL_PEAKS[1]:
        return []
    size = "hardly moves a container" if peak < USUAL_PEAKS[0] else "is beyond almost all records"
    doubt = "" if component.unit_stated else other_units
    return [
        f"its peak, {peak:.3g} m/s2 = {peak / STANDARD_GRAVITY:.2g} g, {size}"
        + (f"{doubt}; is the unit right?" if doubt else "")
    ]
