"""Restitution of blocks that rock freely on concrete and on rubber: three measured numbers.

The abstract gives slenderness, base and restitution over Housner's, and no dimensions. On concrete the size does not
matter, as long as nothing crushes. On rubber it decides: the restitution follows from how far the block sinks in, which
grows with its width. So the width is fitted to the number on rubber, and the two on concrete are predicted.
"""

import math
from functools import cache

import numpy as np
from evidence.findings import prediction
from runs import run
from validation.bodies import rigid_case
from validation.experiments import Experiment, Predictor, measured_table

PRESETS = {"concrete": "concrete C25/30", "rubber": "rubber mat"}
DENSITY = 2400.0  #: of a block of concrete [kg/m3]
WIDTHS = tuple(np.round(np.arange(0.1, 1.001, 0.02), 2).tolist())  #: tried [m]
STRIPS = (0.05, 0.1, 0.25)  #: of the width that bears at each edge
STRIP = 0.1  #: the one taken where only one is
MODULI = (2.0e6, 7.1e6)  #: the range of the preset's Young's modulus [Pa]
WITHIN = 0.03


@cache
def restitution_ratio(
    base: str, slenderness: float, width: float, strip: float = STRIP, modulus: float | None = None
) -> float:
    """Restitution of the first impact over Housner's, of a rigid block as deep as wide [m] on a preset of [floor].

    `strip`: share of the width that bears at each edge; `modulus`: that of the base [Pa], if not the preset's.
    """
    angle = math.atan(1.0 / slenderness)
    rate = math.sqrt(1.5 * 9.81 / (width * math.hypot(1.0, slenderness)))
    patch = [strip * width, width]
    case = rigid_case(
        width=width,
        height=slenderness * width,
        element_size=width,
        container__density_kg_m3=DENSITY,
        floor__preset=PRESETS[base],
        floor__corner_patch_m=patch,
        initial__rotation_rad=0.5 * angle,
        solver__duration_s=8.0 / rate,
        **({} if modulus is None else {"floor__youngs_modulus_Pa": modulus}),
    )
    ratio = run(case).restitution / (1.0 - 1.5 * math.sin(angle) ** 2)
    return ratio if math.isfinite(ratio) else 0.0  # sunk in so far that it does not swing to the other side


def fitted_width(measured: float, strip: float = STRIP, modulus: float | None = None) -> float:
    """The width, of those tried, at which a block of slenderness 5 comes nearest to this restitution over Housner's."""
    return min(
        WIDTHS, key=lambda width: abs(restitution_ratio("rubber", 5.0, width, strip, modulus) - measured)
    )


def compute() -> Experiment:
    """Fit the width of the block to the number on rubber, and predict those on concrete."""
    rows = {(row["base"], float(row["slenderness"])): row for row in measured_table("impacts.csv")}
    measured = {key: float(row["restitution_over_housner"]) for key, row in rows.items()}
    rubber = measured["rubber", 5.0]
    width = fitted_width(rubber)
    fit = restitution_ratio("rubber", 5.0, width)
    widths = ", ".join(f"{fitted_width(rubber, strip):g} m ({100 * strip:g} %)" for strip in STRIPS)
    soft, stiff = (fitted_width(rubber, modulus=modulus) for modulus in MODULI)
    trial_widths = (0.1, 0.2, 0.3, 0.4, 0.5)
    over_widths = ", ".join(f"{restitution_ratio('rubber', 5.0, trial):.2f}" for trial in trial_widths)
    return Experiment(
        name="impacts",
        title="Restitution measured on concrete and rubber",
        source="ElGawady, Ma, Butterworth, Ingham, abstract: taylorfrancis.com/chapters/edit/10.1201/9781003060888-45",
        licence="three numbers, as facts",
        tests=len(rows),
        fitted=f"width of the block, {width:g} m, to the number on rubber; not reported, as its depth (the width is "
        f"taken), its mass (concrete, {DENSITY:g} kg/m3), what bears at each edge ({100 * STRIP:g} % of the width) and "
        "the thickness of the rubber (deep against that). No preset is fitted",
        findings=(
            prediction(
                "slenderness 5 on rubber: restitution over Housner's, width fitted",
                f"{fit:.3f}",
                reference=rubber,
                criterion=f"within {WITHIN} by the fit",
                met=abs(fit - rubber) <= WITHIN,
                note="a fit of one unknown to one number: it shows that the preset can give it, not that it does",
            ),
            prediction(
                f"the same for widths of {', '.join(f'{trial:g}' for trial in trial_widths)} m",
                over_widths,
                reference=rubber,
                note="no prediction without the width",
            ),
            prediction(
                "width fitted with other strips that bear",
                widths,
                reference="not reported",
                note=f"with a modulus of {MODULI[0] / 1e6:g} and {MODULI[1] / 1e6:g} MPa, the range of the preset "
                f"({100 * STRIP:g} %): {soft:g} and {stiff:g} m",
            ),
            *(
                prediction(
                    f"slenderness {slenderness:g} on concrete: restitution over Housner's",
                    f"{(ratio := restitution_ratio('concrete', slenderness, width)):.3f}",
                    reference=measured["concrete", slenderness],
                    telling=True,
                    note=f"a prediction, off by {ratio - measured['concrete', slenderness]:+.3f}: a rigid block on its "
                    "edges loses no more than Housner's, and one so light crushes nothing; give "
                    "contact.restitution_over_housner where it is measured",
                )
                for slenderness in (5.0, 3.0)
            ),
        ),
        others=(
            Predictor(
                name="Housner's impact, on any base",
                agreement=f"off by {1.0 - measured['concrete', 5.0]:.2f}, {1.0 - rubber:.2f}, "
                f"{1.0 - measured['concrete', 3.0]:.2f}",
                source="Housner 1963",
            ),
        ),
    )
