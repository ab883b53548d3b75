"""Files of data that the fuzz feeds the program with: meshes, motion tables, records."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from cases import BLOCK, LEAST
from hypothesis import strategies as st
from inputs import SINE, Input, damaged, values_of
from mesh_writer import mesh_of
from record_files import WRITTEN, synthetic_motion
from small_site import SITE
from small_sweep import SMALL

from fem.case.toml import toml_value
from fem.records.source import MOST_SAMPLES
from mesh.files import FORMATS

Draw = Any
RUN = ("run", "case.toml", "--out", "out", "-q", "--no-band")
#: a rigid block on a motion that is put in, for a moment
CASE = BLOCK.replace('kind = "none"\n', "{motion}").replace("duration_s = 0.05", "duration_s = 0.4")


@st.composite
def meshes(draw: Draw) -> Input:
    """A mesh file with bytes changed, of a block or a shell of two boxes; checked."""
    suffix, shell = draw(st.sampled_from(sorted(FORMATS))), draw(st.booleans())
    whole = mesh_of(suffix, shell=shell)
    wall = "wall_m = 0.02" if shell else 'section = "solid"'
    case = LEAST.replace("[contact]", f'boxes = 2\n{wall}\nmesh_file = "mesh{suffix}"\n[contact]')
    content = draw(st.just(whole) | damaged(whole) | damaged(whole) | damaged(whole))
    return Input(
        arguments=("check", "case.toml"), files={"case.toml": case.encode(), f"mesh{suffix}": content}
    )


@st.composite
def motion_tables(draw: Draw) -> Input:
    """A motion table with bytes changed, or columns of any numbers; run."""
    words = {"quantity": "acceleration", "unit": draw(st.sampled_from(("m/s2", "g")))}
    if draw(st.integers(0, 3)) == 0:
        words = {"quantity": "displacement", "unit": "m"}
    if draw(st.integers(0, 3)) == 0:
        names = ("quantity", "unit", "baseline", "scale", "start", "sample_interval_s", "start_s", "end_s")
        names += ("scale_to_m_s2",) if draw(st.booleans()) else ()
        words |= {name: draw(values_of(f"motion.{name}", None)) for name in names}
    heading = draw(
        st.sampled_from(("", "", "time_s,value\n", "time_s,acc_m_s2\n", "t [s],disp [m]\n", "t,a_g\n"))
    )
    rows = draw(st.just(SINE) | any_rows())
    content = (heading + rows).encode()
    if draw(st.booleans()):
        content = draw(damaged(content))
    lines = "".join(f"{key} = {toml_value(value)}\n" for key, value in words.items())
    case = CASE.format(motion=f'kind = "table"\nfile = "floor.csv"\n{lines}')
    return Input(arguments=RUN, files={"case.toml": case.encode(), "floor.csv": content})


def record_of(name: str) -> str:
    """A file of a format, short enough to be damaged in its header as often as in its numbers."""
    return WRITTEN[name].text(*(component[:200] for component in synthetic_motion()))


@st.composite
def records(draw: Draw) -> Input:
    """A file of any format with bytes changed, as the motion of a case or drawn, in any way of naming it."""
    name = draw(st.sampled_from(sorted(WRITTEN)))
    form, content = WRITTEN[name], draw(damaged(record_of(name).encode()))
    if draw(st.integers(0, 5)) == 0:
        coding = draw(st.sampled_from(("utf-16", "utf-8-sig", "cp500")))
        content = content.decode("utf-8", "replace").encode(coding, "replace")
    said = {"unit": form.unit, "sample_interval": form.sample_interval}
    if draw(st.integers(0, 3)) == 0:
        said["unit"] = draw(st.sampled_from(("g", "gal", "m/s2", "m")))
    channel = draw(st.sampled_from(("", "", "", "#1", "#2", "#Up", "#9", "#")))
    if draw(st.integers(0, 3)) == 0:
        options = [f"--{key.replace('_', '-')}={value}" for key, value in said.items() if value is not None]
        return Input(arguments=("picture", f"motion{channel}", *options), files={"motion": content})
    keys = {"unit": said["unit"], "sample_interval_s": said["sample_interval"]}
    others = st.sampled_from(("start_s", "end_s", "scale_to_m_s2", "baseline", "quantity"))
    for key in draw(st.sets(others, max_size=3)):
        keys[key] = draw(values_of(f"motion.{key}", None))
    keys |= {"vertical.kind": "table"} if draw(st.booleans()) else {}
    named = {key if "." in key else f"motion.{key}": value for key, value in keys.items()}
    changes = [word for key, one in named.items() if one is not None for word in ("--set", f"{key}={one}")]
    command = RUN if draw(st.booleans()) else ("check", "case.toml")
    return Input(
        arguments=(*command, "--motion", f"motion{channel}", *changes),
        files={"case.toml": CASE.format(motion='kind = "none"\n').encode(), "motion": content},
    )


#: content of a size [bytes], up to which it must be refused as soon as a small one
HOSTILE: dict[str, Callable[[int], str]] = {
    "count of PEER": lambda size: record_of("PEER").replace("NPTS=  200", "NPTS= 999999999"),
    "count of ESM": lambda size: record_of("ESM").replace("NDATA: 200", "NDATA: 999999999"),
    "interval": lambda size: record_of("PEER").replace(".0050", "1e-300"),
    "narrow numbers": lambda size: (
        record_of("CSMIP V1").replace("(8f9.6)", "(99f1.0)").partition("\n 200")[0]
        + f"\n {size} Accelerogram points at 200 pts/sec in units of g. Format: (99f1.0)\n"
        + f"{'1' * 99}\n" * (size // 100)
    ),
    "brackets": lambda size: "(" * size + "\n0,1\n1,2\n",
    "underscores": lambda size: "a_" * (size // 2) + "\n0,1\n1,2\n",
    "blanks in a header": lambda size: "a\nb\nc\nNPTS=1" + " " * size + "DT\n1\n",
    "numbers in a line": lambda size: "1," * (size // 2),
    "lines of nothing": lambda size: "\n" * size + "1",
    "a word behind numbers": lambda size: "0.005,-0.123456\n" * min(size // 16, MOST_SAMPLES - 1) + "a",
    "a word behind those of ESM": lambda size: (
        record_of("ESM").replace("NDATA: 200", f"NDATA: {200 + size // 64}").rstrip("\n")
        + "\n-0.12345678" * (size // 64 - 1)
        + "\na"
    ),
}
SIZES = (40, 40_000, 2_000_000, 33_000_000, 60_000_000)
ENDLESS = ("/proc/kmsg", "/dev/zero", "/dev/tty", "/proc/self/mem", "/proc/kcore")


def hostile(name: str, size: int = 0) -> Input:
    """A file of `HOSTILE`, or a motion of another path, to be refused in little time and memory."""
    files = {"case.toml": CASE.format(motion='kind = "none"\n').encode()}
    if name in HOSTILE:
        name, files["motion"] = "motion", HOSTILE[name](size).encode()
    words = ("check", "case.toml", "--motion", name, "--set", "motion.unit=g")
    return Input(arguments=words, files=files, bounded=True)


#: file that a user or a file names -> the command and the files beside it
NAMED: dict[str, tuple[tuple[str, ...], dict[str, str]]] = {
    "case.toml": (("check", "case.toml"), {}),
    "sweep.toml": (("sweep", "sweep.toml"), {}),
    "ensemble.toml": (("ensemble", "ensemble.toml"), {}),
    "site.toml": (("assess", "site.toml"), {}),
    "hall.csv": (("batch", "hall.csv", "--case", "seed_stack"), {}),
    "motion.at2": (("check", "seed_stack", "--motion", "motion.at2"), {}),
    "drawn.at2": (("picture", "drawn.at2"), {}),
    "outcomes.csv": (("validate", "--data", "."), {"body.toml": (
        "mass_kg = 1.0\nheight_m = 1.0\ncentroid_m = 0.5\ninertia_m2 = 0.1\nslenderness_angle_rad = [0.1, 0.2]\n"
    )}),
    "body.toml": (("validate", "--data", "."), {"outcomes.csv": "motion,overturned\n"}),
    "granite_rock_motions.csv.gz": (("validate", "--data", "."), {}),
    "mesh.vtu": (("check", "case.toml"), {"case.toml": CASE.format(motion='kind = "none"\n').replace(
        "[contact]", 'mesh_file = "mesh.vtu"\n[contact]'
    )}),
    "base.toml": (("sweep", "sweep.toml"), {"sweep.toml": SMALL.replace("seed_stack_plateau", "base.toml")}),
    "container.toml": (("assess", "site.toml"), {"site.toml": SITE.replace("seed_stack", "container.toml")}),
    "floor.csv": (("assess", "site.toml"), {"site.toml": f'{SITE}[floor_spectrum]\nfile = "floor.csv"\n'}),
    "record.at2": (("assess", "site.toml"), {"site.toml": SITE.replace(
        "count = 3", 'vertical = false\nsource = "records"\nfiles = [["record.at2"], ["b.at2"], ["c.at2"]]'
    )}),
}  # fmt: skip
#: of these, those that are named by a file: a link may not lead out of its folder
BY_A_FILE = ("mesh.vtu", "base.toml", "container.toml", "floor.csv", "record.at2")


def large(path: Path) -> None:
    """A file of 600 MB that takes no room."""
    path.touch()
    os.truncate(path, 600_000_000)


SPECIAL: dict[str, Callable[[Path], None]] = {
    "device": lambda path: path.symlink_to("/dev/zero"),
    "file of the kernel": lambda path: path.symlink_to("/proc/kmsg"),
    "pipe": os.mkfifo,
    "folder": Path.mkdir,
    "circle": lambda path: path.symlink_to(path.name),
    "large": large,
}


def special(name: str, kind: str) -> Input:
    """A command that reads a file which is none."""
    command, files = NAMED[name]
    return Input(
        arguments=command,
        files={key: text.encode() for key, text in files.items()},
        made={name: SPECIAL[kind]},
        bounded=True,
    )


@st.composite
def hostile_records(draw: Draw) -> Input:
    """A small file that asks for much memory or time, a large one that is no motion, or one without an end."""
    if draw(st.integers(0, 3)) == 0:
        return hostile(draw(st.sampled_from(ENDLESS)))
    return hostile(draw(st.sampled_from(sorted(HOSTILE))), draw(st.sampled_from(SIZES)))


@st.composite
def any_rows(draw: Draw) -> str:
    """Rows of a table: rising times and moderate values, some of them replaced by any number."""
    steps = draw(st.lists(st.floats(1e-6, 1.0), max_size=30))
    times = [float(instant) for instant in np.cumsum(steps)]
    values = draw(st.lists(st.floats(-3.0, 3.0), min_size=len(times), max_size=len(times)))
    for column in (times, values):
        for _ in range(draw(st.integers(0, 2)) if column and draw(st.booleans()) else 0):
            column[draw(st.integers(0, len(column) - 1))] = draw(st.floats() | st.sampled_from(column))
    mark = draw(st.sampled_from((",", ",", ";", " ", "\t")))
    return "".join(f"{t!r}{mark}{v!r}\n" for t, v in zip(times, values, strict=True))


#: as `inputs.KINDS`
KINDS: dict[str, st.SearchStrategy[Input]] = {
    "mesh": meshes(),
    "table": motion_tables(),
    "record": records(),
    "hostile": hostile_records(),
}
