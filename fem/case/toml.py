"""The keys of a case with every default, and tables as TOML that reads back to the same values, bit for bit."""

import json
from collections.abc import Mapping
from decimal import Decimal
from typing import Any

from fem.case.data_files import FILE_KEYS, copied_name
from fem.case.tables.all_tables import TABLES
from fem.case.tables.floors import PENALTY_KEYS
from fem.case.tables.links import ROWS


def toml_value(value: object) -> str:
    """A scalar, or a list of scalars, as TOML 1.0; a float keeps all its digits. TypeError: anything else."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(int(value))
    if isinstance(value, float):
        # the shortest digits that read back to the same number; large ones with an exponent
        large = 1e6 <= abs(value) < float("inf")
        return format(Decimal(repr(float(value))).normalize(), "e") if large else repr(float(value))
    if isinstance(value, str):
        # JSON escapes what TOML wants escaped, except the delete character.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(toml_value, value))}]"
    raise TypeError(f"no TOML scalar: {type(value).__name__}")


def toml_document(tables: Mapping[str, Any]) -> str:
    """Scalars first, then one table after another, each with its own tables behind it.

    Args:
        tables: key -> scalar, or table name -> mapping of keys to scalars and to sequences of such mappings, or
            such a sequence itself.
    """
    scalars = {
        key: table
        for key, table in tables.items()
        if not isinstance(table, Mapping) and not _are_tables(table)
    }
    top = [f"{key} = {toml_value(value)}" for key, value in scalars.items()]
    blocks = ["\n".join(top)] if top else []
    for name, content in tables.items():
        if isinstance(content, Mapping):
            rows = {key: value for key, value in content.items() if _are_tables(value)}
            own = {key: value for key, value in content.items() if key not in rows}
            blocks.append(_block(f"[{name}]", own))
            blocks += [_block(f"[[{name}.{key}]]", row) for key, value in rows.items() for row in value]
        elif name not in scalars:
            blocks += [_block(f"[[{name}]]", table) for table in content]
    return "\n\n".join(blocks) + "\n"


def _are_tables(value: object) -> bool:
    return isinstance(value, list | tuple) and bool(value) and isinstance(value[0], Mapping)


def _block(heading: str, content: Mapping[str, Any]) -> str:
    return "\n".join([heading, *(f"{key} = {toml_value(value)}" for key, value in content.items())])


def resolved_tables(case: Any) -> dict[str, Any]:
    """Every key of a case that is used, defaults included, by table.

    A case without vertical motion, on a level rigid floor, of equal bolted prisms that bear on all of their base,
    without stops and ties, has no keys of these, and keeps its hash. What [joints] leaves out stays out: the floor's
    friction stands in its place, and the band treats it as unknown.
    """
    document = case.model_dump(by_alias=True, exclude={*TABLES, *ROWS})
    level = not case.floor.is_slab and case.floor.slope_percent == 0.0
    joints = case.container.is_loose and any(value is not None for value in vars(case.joints).values())
    says_nothing = {"vertical": not case.has_vertical, "floor": level, "joints": not joints}
    for name in TABLES:
        table = getattr(case, name)
        if table is None or says_nothing.get(name, False):
            continue
        idle: tuple[str, ...] = ()
        if name == "contact" and case.floor.is_slab:
            idle = (
                PENALTY_KEYS if case.contact_damping_ratio is not None else (*PENALTY_KEYS, "damping_ratio")
            )
        document[name] = {
            key: value
            for key, value in table.model_dump().items()
            if value is not None and key not in idle and not table.is_idle(key)
        }
    container, support = document["container"], document["support"]
    if not case.container.is_loose:
        del container["joints"]
        if case.joints.bolt_capacity_N is not None and case.container.bolted_joints:
            document["joints"] = {"bolt_capacity_N": case.joints.bolt_capacity_N}
    for table, key, usual in (
        (container, "shape", "prism"),
        (container, "eccentricity_m", 0.0),
        (support, "effective_width", 1.0),
    ):
        if table[key] == usual:
            del table[key]
    if case.support.camber_m == 0.0:
        del support["camber_m"], support["rocking_damping_ratio"]
    if case.container.box is not None:
        del container["boxes"]
        # with all that each takes from [container], so that the file reads back to the same boxes
        container["box"] = [
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
