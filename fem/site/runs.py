"""The runs of a verification: the case of each, the columns of its row; and its containers as bodies.

A rigid body that neither uplifts nor slips under the whole motion need not be computed: the bound is that of
`fem.model.resting`.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from fem.case.case import Case, CaseError, read_case
from fem.case.data_files import FILE_KEYS
from fem.case.tables.input_ranges import TOLERANCE
from fem.case.toml import toml_document
from fem.model.geometry import build_container
from fem.model.resting import BodyAtRest
from fem.model.static_checks import static_checks_of
from fem.results.figures import Place, columns_of, types_of
from fem.run.band import tolerance_of_draws
from fem.site.request import EMPTY, SiteRequest
from fem.site.result import MOTIONS, REPEATED, SET, RunKey, SiteBody, SiteRun
from fem.study.design import CaseMaker
from fem.study.runner import Row

CONFIRMING = "reduced"  #: model with which the deciding runs are repeated
MOST_DECIDING = 2  #: and how many of them there are at most
NOT_COMPUTED = "below uplift and slip of a rigid body: not computed"
#: the columns that tell which run a row is of
KEYS = (
    *("stage", "motion", "vertical_sign", "mu_static", "mu_kinetic"),
    *("mass", "elevation", "building_period_s", "model", "factor"),
)
FOUND = {"outcome": str} | columns_of(Place.RUNS)
COLUMNS = {name: types_of(RunKey)[name] for name in KEYS} | FOUND | {"reason": str}


def key_of(run: SiteRun | Row) -> RunKey:
    """What a run, or that of a row, is made of."""
    return RunKey(**{name: run[name] for name in KEYS})


def cells_of(key: RunKey) -> tuple[Any, ...]:
    """The first cells of its row."""
    return tuple(getattr(key, name) for name in KEYS)


def cases_of(request: SiteRequest, folder: Path) -> Callable[[RunKey], Case]:
    """What makes the case of a run, picklable; its motion is read from the folder of results.

    That raises CaseError where the motion is missing.
    """
    model = request.heading.model
    makers = {name: CaseMaker(still(case, model)) for name, case in request.variants.items()}
    return partial(_case, folder.resolve() / MOTIONS, makers)


def _case(place: Path, makers: Mapping[tuple[str, str], CaseMaker], key: RunKey) -> Case:
    make = makers[key.mass, key.elevation]
    values: dict[str, Any] = {
        "solver.model": key.model,
        "contact.mu_static": key.mu_static,
        "contact.mu_kinetic": key.mu_kinetic,
        "motion.kind": "table",
        "motion.file": str(place / f"{key.stem}_h.csv"),
        "motion.scale": key.factor,
    }
    if key.stage not in (SET, REPEATED):  # others are counted, or seek the margin of the rule
        values[TOLERANCE] = tolerance_of_draws(make.base)
    if key.vertical_sign:
        values |= {
            "vertical.kind": "table",
            "vertical.file": str(place / f"{key.stem}_v.csv"),
            "vertical.scale": key.vertical_sign * key.factor,
        }
    return make(values)


def still(case: Case, model: str) -> Case:
    """A case without its own motion and start, whose files may lie anywhere."""
    data = case.given() | {"motion": {"kind": "none"}}
    for name in ("vertical", "initial", "static"):
        data.pop(name, None)
    alone = read_case(toml_document(data), name=case.name, folder=case.folder)
    origin = replace(alone.origin_with({}), trusted=frozenset(FILE_KEYS), allow_outside=True)
    return alone.from_origin(origin).with_values(
        {
            "solver.model": model,
            "solver.duration_s": "auto",
            "output.fields_s": 0.0,
            "output.stop_when_still": True,
        }
    )


def bodies_of(request: SiteRequest) -> tuple[SiteBody, ...]:
    """Mass, dimensions and rocking parameters of every container that is run.

    Raises:
        CaseError, MeshError: one cannot be built.
    """
    bodies = []
    for (mass, elevation), case in request.variants.items():
        try:
            mesh = build_container(case)
        except ValueError as error:
            if mass == EMPTY:
                raise CaseError(f"empty_mass_kg: {error}") from None
            raise
        static = static_checks_of(case, mesh, 0.0)
        bodies.append(
            SiteBody(
                mass=mass,
                elevation=elevation,
                mass_kg=mesh.mass,
                centroid_m=static.centroid,
                inertia_kg_m2=static.inertia,
                support_width_m=static.width,
                width_m=case.container.width_m,
                height_m=case.container.total_height,
                depth_m=case.container.depth_m,
                gravity_m_s2=case.gravity_m_s2,
                slenderness_angle_rad=static.slenderness_angle,
                frequency_parameter_1_s=static.frequency_parameter,
                uplift_acceleration_m_s2=static.uplift_acceleration,
                housner_restitution=static.housner_restitution,
            )
        )
    return tuple(bodies)


def at_rest_by_the_bound(request: SiteRequest) -> dict[tuple[str, str], BodyAtRest]:
    """The rigid bodies that a bound may show to be at rest, by weight and elevation.

    None of a container that rolls on a cambered base, that is not run as a rigid one, or below which the floor gives
    way.

    Raises:
        CaseError, MeshError: one cannot be built.
    """
    bodies = {}
    for name, variant in request.variants.items():
        case = variant.with_values({"solver.model": request.heading.model})
        mesh = build_container(case)
        bodies[name] = BodyAtRest.of(case, mesh, static_checks_of(case, mesh, 0.0))
    return {name: body for name, body in bodies.items() if body is not None}
