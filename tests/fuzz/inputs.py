"""What the fuzz feeds the program with, as strategies of hypothesis: case tables and TOML bytes.

Tables of a case are drawn from the models of `fem.case.tables` themselves: a new key, choice or range is tried without
a change here. Only what makes a run long is bounded, in `CHEAP`.
"""

import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import NoneType
from typing import Any, Literal, get_args, get_origin

import numpy as np
from hypothesis import strategies as st
from mesh_writer import mesh_of
from pydantic.fields import FieldInfo

from fem.case.case import Case
from fem.case.files import CASES
from fem.case.overrides import with_overrides
from fem.case.tables.all_tables import TABLES, CaseHeading
from fem.case.tables.input_ranges import UnknownNumber
from fem.case.tables.quantities import Quantity
from fem.case.tables.table import CaseTable
from fem.case.tables.unknown_inputs import UNKNOWN
from fem.case.toml import toml_value
from fem.case.validation import known_keys, quantity_of

Tables = dict[str, Any]
Draw = Any


@dataclass(frozen=True, kw_only=True)
class Input:
    """Files in a folder of their own, and what stands behind `python -m fem` there."""

    arguments: tuple[str, ...]
    files: Mapping[str, bytes] = field(default_factory=dict)
    made: Mapping[str, Callable[[Path], None]] = field(default_factory=dict)  #: files that are no bytes
    bounded: bool = False  #: to be refused in little time and memory


#: every key of a case file, dotted
FIELDS: dict[str, FieldInfo] = known_keys(CaseHeading) | {
    f"{table}.{key}": info for table, model in TABLES.items() for key, info in known_keys(model).items()
}
#: tables of which a case may have several
LISTS = {name: get_args(Case.model_fields[name].annotation)[0] for name in ("stop", "tie", "neighbour")}
#: ranges, for values that are meant to be valid, of what a run takes long for
CHEAP = {
    "solver.duration_s": (1e-3, 0.4),
    "solver.step_s": (1e-5, 10.0),
    "solver.elastic_modes": (0, 30),
    "output.history_s": (1e-4, 10.0),
    "output.fields_s": (0.02, 10.0),
}
CELLS = 200  #: about as many at most, of a mesh that is meant to be valid
FULL_DURATION = 0.03  #: of the full model, whose steps are dear [s]
NASTY = (
    "-1", "0", "1e-300", "1e300", "nan", "inf", "-inf", '"text"', '""', "true", "[]", "[1, 2]", "{}", "1979-05-27",
    "10000000000000000000000", '"../../etc/passwd"', '"/etc/passwd"', '"auto"', '"a\\u0000b"', "0x7fffffff", "1e-9",
)  # fmt: skip
PIECES = (b"9", b"-", b"e", b".", b"0", b"nan", b"1e999", b"\n", b'"', b"[", b",", b"\x00", b"\xff")
FILE_NAMES = ("floor.csv", "mesh.msh", "case.toml", "../floor.csv", "/dev/zero", "none.csv", "")
SINE = "".join(f"{0.01 * k:.2f},{np.sin(0.3 * k):.6f}\n" for k in range(60))


@st.composite
def runs(draw: Draw) -> Input:
    """A shipped case with keys of the schema changed to anything that they allow, and a little nonsense, run."""
    tables = draw(cases_by_schema())
    text = document_of(tables, draw(st.lists(damages(), max_size=2)) if draw(st.integers(0, 2)) == 0 else [])
    files = {"case.toml": text, "floor.csv": SINE.encode(), "mesh.msh": mesh_of(".msh", shell=False)}
    return Input(arguments=("run", "case.toml", "--out", "out", "-q", "--no-band"), files=files)


@st.composite
def cases_by_schema(draw: Draw) -> Tables:
    """A shipped case, up to nine keys of which hold other values that their fields allow; cheap to run."""
    tables = tomllib.loads(CASES.text(draw(st.sampled_from(CASES.names))))
    quick = {
        "solver.model": draw(st.sampled_from(("rigid",) * 5 + ("reduced",) * 2 + ("full",))),
        "solver.duration_s": draw(st.floats(0.01, 0.3)),
        "output.figures": False,
        "output.fields_s": 0.0,
    }
    tables = with_overrides(tables, quick | draw(st.one_of(st.just({}), vertical_motions())))
    chosen = draw(st.sets(st.sampled_from(sorted(FIELDS)), max_size=9))
    values = {key: draw(values_of(key, present(tables, key))) for key in sorted(chosen)}
    tables = with_overrides(tables, values)
    for name in draw(st.sets(st.sampled_from(sorted(LISTS)), max_size=1)):
        tables[name] = draw(values_of_type(name, LISTS[name], None, None))
    bound_the_cost(tables)
    return tables


@st.composite
def vertical_motions(draw: Draw) -> dict[str, Any]:
    """Keys of a vertical motion, up to a floor that falls three times as fast as the container."""
    keys: dict[str, st.SearchStrategy[Any]] = {
        "peak_acceleration_m_s2": st.floats(0.0, 30.0),
        "scale": st.sampled_from((1.0, -1.0, 0.3)),
    }
    if draw(st.booleans()):
        keys |= {"kind": st.just("harmonic"), "frequency_Hz": st.floats(0.5, 40.0)}
        keys["phase_rad"] = st.floats(-3.0, 3.0)
    else:
        shapes = st.sampled_from(("rectangular", "half-sine", "sine"))
        keys |= {"kind": st.just("pulse"), "shape": shapes, "pulse_s": st.floats(1e-3, 0.5)}
        keys["delay_s"] = st.sampled_from((0.0, 0.02))
    return {f"vertical.{key}": draw(values) for key, values in keys.items()}


def present(tables: Tables, key: str) -> Any:
    table, _, name = key.rpartition(".")
    return (tables.get(table, {}) if table else tables).get(name)


def bound_the_cost(tables: Tables) -> None:
    """Elements as large, and runs of the full model as short, as a fuzz can wait for."""
    box, solver = tables["container"], tables["solver"]
    boxes, foot = box.get("boxes", 1), tables.get("support", {}).get("foot_m", 1.0)
    area = box["width_m"] * box["height_m"] * boxes
    least = (area / CELLS) ** 0.5
    solver["element_size_m"] = max(solver.get("element_size_m", 0.1), least, 0.5 * box["width_m"])
    dear = solver["model"] != "rigid" or "step_s" in solver or "history_s" in tables.get("output", {})
    if solver["duration_s"] == "auto" and dear:  # up to a minute of free motion
        solver["duration_s"] = 0.2
    if solver["model"] == "full":
        solver["duration_s"] = min(solver["duration_s"], FULL_DURATION)
        solver["element_size_m"] = max(solver["element_size_m"], 0.5 * box["height_m"], 0.5 * foot)


def values_of(key: str, now: Any) -> st.SearchStrategy[Any]:
    """What a field allows, of each of the types that it may hold."""
    return values_of_field(key, FIELDS[key], now)


def values_of_field(key: str, info: FieldInfo, now: Any) -> st.SearchStrategy[Any]:
    quantity = quantity_of(info.annotation, info.metadata)
    kinds = [kind for kind in types_in(info.annotation) if kind is not NoneType]
    return st.one_of(*(values_of_type(key, kind, quantity, now) for kind in kinds))


def types_in(annotation: Any) -> list[Any]:
    """Plain types and literals in an annotation."""
    parts = [part for part in get_args(annotation) if not isinstance(part, Quantity)]
    if get_origin(annotation) in (Literal, list) or not parts:
        return [annotation]
    return [kind for part in parts if isinstance(part, type) or get_args(part) for kind in types_in(part)]


def values_of_type(key: str, kind: Any, quantity: Quantity | None, now: Any) -> st.SearchStrategy[Any]:
    if get_origin(kind) is Literal:
        return st.sampled_from(get_args(kind))
    if get_origin(kind) is list:
        table, _, name = key.partition(".")
        ranges = {one.name: one.quantity for one in UNKNOWN if isinstance(one, UnknownNumber)}
        stated = ranges[name] if table == "uncertainty" else quantity
        assert stated is not None, key
        pair = st.lists(numbers(stated, None, float, None), min_size=2, max_size=2)
        return pair.map(sorted) if table == "uncertainty" else pair
    if isinstance(kind, type) and issubclass(kind, CaseTable):  # one of a list of tables
        known = known_keys(kind)
        keys = {name: values_of_field(f"{key}.{name}", info, None) for name, info in known.items()}
        needed = {name: keys.pop(name) for name, info in known.items() if info.is_required()}
        return st.lists(st.fixed_dictionaries(needed, optional=keys), min_size=1, max_size=3)
    if kind is bool:
        # figures take a second to draw
        return st.sampled_from((False,) * 20 + (True,)) if key == "output.figures" else st.booleans()
    if kind is str:
        return st.sampled_from(FILE_NAMES) | st.text(max_size=30) if "file" in key else st.text(max_size=600)
    assert quantity is not None and kind in (int, float), f"{key}: no strategy for {kind}"
    return numbers(quantity, CHEAP.get(key), kind, now)


def numbers(
    quantity: Quantity, cheap: tuple[float, float] | None, kind: type, now: Any
) -> st.SearchStrategy[Any]:
    """Near what stands there, at the ends of the range, and anywhere in it by the number or its magnitude."""
    low, high = bounds(quantity)
    if cheap is not None:
        low, high = max(low, cheap[0]), min(high, cheap[1])
    if kind is int:
        return st.integers(int(low), int(high))
    least = low if low > 0.0 else 1e-9 * high
    spread = st.floats(np.log(least), np.log(high)).map(np.exp).map(float)
    middle = now if isinstance(now, int | float) and now else quantity.typical or min(max(low, 1.0), high)
    near = st.floats(-1.0, 1.0).map(lambda power: float(middle * 3.0**power))
    anywhere = st.sampled_from((low, high)) | st.floats(low, high) | spread
    if low < 0.0:
        anywhere = anywhere | spread.map(lambda value: -value)
    return st.one_of(near, near, near, anywhere).map(lambda value: float(min(max(value, low), high)))


def bounds(quantity: Quantity) -> tuple[float, float]:
    """The smallest and the largest number that a quantity allows."""
    low = quantity.least if quantity.above is None else float(np.nextafter(quantity.above, np.inf))
    high = quantity.most if quantity.below is None else float(np.nextafter(quantity.below, -np.inf))
    return 0.0 if low is None else low, 1e12 if high is None else high


@st.composite
def damages(draw: Draw) -> tuple[str, str, str, str]:
    """One thing wrong: which key, what is done, and what to."""
    dotted = draw(st.sampled_from(sorted(FIELDS)))
    table, _, key = dotted.rpartition(".")
    kind = draw(st.sampled_from(("replace", "replace", "drop", "misspell", "retable")))
    return kind, table, key, draw(st.sampled_from(NASTY) | st.floats().map(repr))


def written_value(value: Any) -> str:
    """A value as TOML; of a list of tables each in braces."""
    if not (isinstance(value, list) and value and isinstance(value[0], dict)):
        return toml_value(value)
    inline = (", ".join(f"{key} = {toml_value(item)}" for key, item in table.items()) for table in value)
    return "[" + ", ".join(f"{{{one}}}" for one in inline) + "]"


def document_of(tables: Tables, wrong: list[tuple[str, str, str, str]]) -> bytes:
    """The text of a case with these damages."""
    top = {key: written_value(value) for key, value in tables.items() if not isinstance(value, dict)}
    text = {
        name: {key: written_value(value) for key, value in content.items()}
        for name, content in tables.items()
        if isinstance(content, dict)
    }
    for kind, table, key, value in wrong:
        content = text.setdefault(table, {}) if table else top
        match kind:
            case "replace":
                content[key] = value
            case "drop":
                content.pop(key, None)
            case "misspell":
                content[f"{key[:-1]}x"] = content.pop(key, value)
            case "retable":
                text.setdefault(f"{table}x", {})[key] = content.pop(key, value)
    lines = [f"{key} = {value}" for key, value in top.items()]
    for name, content in text.items():
        lines += [f"[{name}]", *(f"{key} = {value}" for key, value in content.items())]
    return "\n".join(lines).encode()


@st.composite
def damaged(draw: Draw, content: bytes) -> bytes:
    """One to six bytes or pieces changed, dropped, doubled or moved."""
    data = bytearray(content)
    place, length = st.integers(0, len(content)), st.integers(1, 40)
    for _ in range(draw(st.integers(1, 6))):
        at, many = draw(place), draw(length)
        match draw(st.integers(0, 4)):
            case 0:
                data[at : at + 1] = draw(st.binary(min_size=1, max_size=1))
            case 1:
                del data[at : at + many]
            case 2:
                data[at:at] = data[at : at + many]
            case 3:
                data[at : at + 1] = draw(st.sampled_from(PIECES))
            case _:
                other = draw(place)
                data[at:at] = data[other : other + many]
    return bytes(data)


def toml_trees() -> st.SearchStrategy[str]:
    """TOML documents of any content: nested tables and lists under names that are known or are not."""
    scalars = st.sampled_from(NASTY) | st.integers().map(str) | st.floats().map(repr)
    scalars |= st.text(max_size=20).map(toml_value)

    def listed(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
        return st.lists(inner, max_size=3).map(lambda parts: f"[{', '.join(parts)}]")

    values = st.recursive(scalars, listed, max_leaves=8)
    known = sorted({key.rpartition(".")[2] for key in FIELDS})
    names = st.sampled_from(known) | st.text(max_size=8).map(toml_value)
    lines = st.lists(st.tuples(names, values).map(" = ".join), max_size=6).map("\n".join)
    tables = st.lists(st.tuples(st.sampled_from([*TABLES, '"x.y"', "container.width_m"]), lines), max_size=4)
    return st.tuples(lines, tables).map(
        lambda parts: "\n".join([parts[0], *(f"[{name}]\n{content}" for name, content in parts[1])])
    )


@st.composite
def texts(draw: Draw) -> Input:
    """A shipped case with bytes changed, TOML of no meaning, any bytes, or any `--set`; checked."""
    shipped = CASES.text(draw(st.sampled_from(CASES.names))).encode()
    what = draw(st.integers(0, 9))
    if what == 0:
        key = draw(st.sampled_from(sorted(FIELDS)) | st.text(max_size=9))
        change = f"{key}={draw(st.sampled_from(NASTY) | st.text(max_size=20))}"
        return Input(arguments=("check", "case.toml", "--set", change), files={"case.toml": shipped})
    contents = {1: st.binary(max_size=400), 2: toml_trees().map(str.encode)}
    content = draw(contents.get(what, damaged(shipped)))
    return Input(arguments=("check", "case.toml"), files={"case.toml": content})


#: inputs by name
KINDS: dict[str, st.SearchStrategy[Input]] = {"case": runs(), "text": texts()}
