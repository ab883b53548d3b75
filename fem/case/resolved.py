"""The keys of a case with every default, as its resolved file has them.

A case without vertical motion, on a level rigid floor, of equal bolted prisms that bear on all of their base, without
stops and ties, has no keys of these, and keeps its hash.
What [joints] leaves out stays out: the floor's friction stands in its place, and the band treats it as unknown.
"""

from typing import Any

from fem.case.data_files import FILE_KEYS, copied_name
from fem.case.tables.all_tables import TABLES
from fem.case.tables.floors import PENALTY_KEYS
from fem.case.tables.links import ROWS


def resolved_tables(case: Any) -> dict[str, Any]:
    """Every key of a case that is used, defaults included, by table."""
    document = case.model_dump(by_alias=True, exclude={*TABLES, *ROWS})
    level = not case.floor.is_slab and case.floor.slope_percent == 0.0
    joints = case.container.is_loose and any(value is not None for value in vars(case.joints).values())
    says_nothing = {"vertical": not case.has_vertical, "floor": level, "joints": not joints}
    for name in TABLES:
        table = getattr(case, name)
        if table is None or says_nothing.get(name, False):
            continue
        idle = table.idle_keys()
        if name == "contact" and case.floor.is_slab:
            idle = idle | {
                *PENALTY_KEYS,
                *(() if case.contact_damping_ratio is not None else ("damping_ratio",)),
            }
        document[name] = {
            key: value for key, value in table.model_dump().items() if value is not None and key not in idle
        }
    if not case.container.is_loose:
        del document["container"]["joints"]
        if case.joints.bolt_capacity_N is not None and case.container.bolted_joints:
            document["joints"] = {"bolt_capacity_N": case.joints.bolt_capacity_N}
    if not case.container.is_round:
        del document["container"]["shape"]
    if case.container.eccentricity_m == 0.0:
        del document["container"]["eccentricity_m"]
    if case.support.camber_m == 0.0:
        del document["support"]["camber_m"], document["support"]["rocking_damping_ratio"]
    if case.support.effective_width == 1.0:
        del document["support"]["effective_width"]
    if case.container.box is not None:
        del document["container"]["boxes"]
        # with all that each takes from [container], so that the file reads back to the same boxes
        document["container"]["box"] = [
            {
                **{"width_m": box.width, "height_m": box.height, "mass_kg": box.mass},
                **{"centroid_m": box.centroid} | ({} if box.wall is None else {"wall_m": box.wall}),
                "offset_m": table.offset_m,
            }
            for box, table in zip(case.stack, case.container.box, strict=True)
        ]
    for name in ROWS:
        rows = [table.model_dump(by_alias=True, exclude_none=True) for table in getattr(case, name)]
        document |= {name: rows} if rows else {}
    for dotted in FILE_KEYS:
        name, _, key = dotted.partition(".")
        content = document.get(name, [])
        for table in content if name in ROWS else [content]:
            if key in table:
                table[key] = copied_name(case.folder, table[key])
    return document
