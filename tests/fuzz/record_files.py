"""Motion files in every format that is read, written here from one synthetic motion of three components.

Accelerations are given in m/s2; each writer converts them to the unit of its format and prints its digits.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import KW_ONLY, dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

G = 9.80665
STEP = 0.005
Array = NDArray[np.float64]
#: heading of a file by the name of its format, with fields in braces
HEADS = dict(
    part.removesuffix("\n").split("\n", 1)
    for part in (Path(__file__).parent / "record_heads.txt").read_text(encoding="utf-8").split("@ ")[1:]
)


def synthetic_motion(count: int = 2003, peak: float = 3.0) -> tuple[Array, Array, Array]:
    """Two horizontal components and a vertical one, as noise under an envelope [m/s2].

    The sixth and seventh values are negative and large, so that they touch in every fixed width.
    """
    rng = np.random.default_rng(16)
    times = STEP * np.arange(count)
    envelope = peak * np.exp(-0.5 * ((times - 0.4 * times[-1]) / (0.2 * times[-1])) ** 2)
    found = [envelope * np.tanh(rng.normal(size=count)) for _ in range(3)]
    for component in found:
        component[5:8] = -0.9 * peak
    return found[0], found[1], found[2]


def rows(values: Sequence[str], per_line: int) -> list[str]:
    """Fields that stand side by side, so many in a line."""
    return ["".join(values[k : k + per_line]) for k in range(0, len(values), per_line)]


def joined(values: Sequence[Array], form: str, mark: str = "") -> Iterator[str]:
    """Rows of columns."""
    return (mark.join(f"{x:{form}}" for x in row) for row in zip(*values, strict=True))


def head(name: str, *values: Array, **words: object) -> list[str]:
    """The lines above the numbers of components, from `record_heads.txt`."""
    peaks = [float(np.abs(one).max()) for one in values]
    count = len(values[0])
    text = HEADS[name].format(count=count, duration=count * STEP, peak=max(peaks), peaks=peaks, **words)
    return text.split("\n")


def fortran_e(value: float, width: int, digits: int) -> str:
    """A number as Fortran's E format prints it, with a zero before the point left out where it has no room."""
    mantissa, exponent = f"{value:.{digits - 1}E}".split("E")
    shifted = f"{float(mantissa) / 10.0:.{digits}f}"
    text = f"{shifted}E{int(exponent) + (1 if value else 0):+03d}"
    return (text if len(text) <= width else text.replace("0.", ".", 1)).rjust(width)


def peer(
    values: Array, component: str = "230", *, old: bool = False, title: str = "ACCELERATION", unit: str = "G"
) -> str:
    """Five numbers of 15 columns in a line; `values` in the unit."""
    count = f"NPTS=  {len(values)}, DT=   .0050 SEC" if not old else f"  {len(values)}    0.0050    NPTS, DT"
    heading = [
        "PEER NGA STRONG MOTION DATABASE RECORD",
        f"Nowhere-02, 1/2/1999, Test Array #9, {component}",
        f"{title} TIME {'HISTORY' if old else 'SERIES'} IN UNITS OF {unit}",
        count,
    ]
    return "\n".join([*heading, *rows([fortran_e(v, 15, 7) for v in values], 5)]) + "\n"


def esm(values: Array, stream: str = "HNE", *, data_type: str = "ACCELERATION", unit: str = "cm/s^2") -> str:
    """64 lines of keys, one number in a line; `values` in the unit."""
    lines = head("ESM", values, stream=stream, data_type=data_type, unit=unit)
    return "\n".join([*lines, *(f"{v:.6f}" for v in values)]) + "\n"


def knet(values: Array, direction: str = "N-S", *, offset: int = 12345) -> str:
    """17 lines, then 8 counts of 9 columns in a line; `values` in gal; a number of samples that is whole seconds."""
    counts = np.rint(values * 6182761 / 3920).astype(int) + offset
    lines = rows([f"{count:9d}" for count in counts], 8)
    return "\n".join([*head("K-NET", values, direction=direction), *lines]) + "\n"


def smc(values: Array, component: str = "90", *, title: str = "2 CORRECTED ACCELEROGRAM") -> str:
    """11 lines of text, 48 whole numbers, 50 reals, two comments, 8 numbers of 10 columns; `values` in cm/s2."""
    whole, real = [-32768] * 48, [1.7e38] * 50
    whole[15], whole[16], whole[17], real[1] = 2, len(values), 0, 1.0 / STEP
    text = [title, "*", "TST", "1999 01 02", "", f"station = Nowhere      component= {component}", *["*"] * 5]
    text += rows([f"{n:10d}" for n in whole], 8) + rows([f"{r:15.7E}" for r in real], 5)
    return "\n".join([*text, "| a comment", "| another", *rows([f"{v:10.5f}" for v in values], 8)]) + "\n"


def cosmos(
    channels: Sequence[tuple[Array, int]],
    *,
    code: int = 4,
    unit: str = "cm/sec2(04)",
    volume: str = "Corrected",
    comment: str = "two",
) -> str:
    """Channels of values in the unit and codes of direction."""
    text: list[str] = []
    for number, (values, direction) in enumerate(channels, start=1):
        whole, real = [-999] * 100, [-999.0] * 100
        whole[0], whole[1], whole[2], whole[53] = 2, 1, code, direction
        real[61], real[62] = 1e3 * STEP, len(values) * STEP
        text += [
            *head("COSMOS", values, number=number, direction=direction, volume=volume),
            " 100 Integer-header values follow on  10 lines, Format= (10I8)", *rows([f"{n:8d}" for n in whole], 10),
            " 100 Real-header values follow on  20 lines, Format= (5F15.6)", *rows([f"{r:15.6f}" for r in real], 5),
            '   2 Comment line(s) follow, each starting with a "|":', "| one", f"| {comment}",
            f"{len(values):8d} acceleration pts, approx {len(values) * STEP:.0f} secs, units={unit},Format=(8f10.5)",
            *rows([f"{v:10.5f}" for v in values], 8),
            f"End-of-data for Chan  {number} acceleration",
        ]  # fmt: skip
    return "\n".join(text) + "\n"


def csmip_v2(channels: Sequence[tuple[Array, str]]) -> str:
    """Channels of values in cm/s2 and words of direction, each with a velocity and a displacement behind it."""
    text: list[str] = []
    for number, (values, direction) in enumerate(channels, start=1):
        text += head("CSMIP V2", values, number=number, direction=direction)
        text += rows([f"{-999:5d}"] * 100, 16) + rows([f"{-999.0:10.5f}"] * 100, 8)
        for quantity, unit in (("accel", "cm/sec2."), ("veloc", "cm/sec."), ("displ", "cm.")):
            text.append(
                f" {len(values)} points of {quantity} data equally spaced at 0.005 sec, in {unit} (8f10.5)"
            )
            text += rows([f"{v:10.5f}" for v in (values if quantity == "accel" else 0.01 * values)], 8)
        text.append(f"/&  ----------  End of data for channel {number:2d}  ----------")
    return "\n".join(text) + "\n"


def csmip_v1(channels: Sequence[tuple[Array, str]]) -> str:
    """Channels of values in g and words of direction."""
    text: list[str] = []
    for number, (values, direction) in enumerate(channels, start=1):
        text += [
            *head("CSMIP V1", values, number=number, direction=direction),
            *rows([f"{-999:5d}"] * 100, 16), *rows([f"{-999.0:10.5f}"] * 50, 8),
            f" {len(values)} Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)",
            *rows([f"{v:9.6f}"[:9] for v in values], 8),
            f"/&  ----------  End of data for channel {number:2d}  ----------",
        ]  # fmt: skip
    return "\n".join(text) + "\n"


def afad(values: Sequence[Array]) -> str:
    """17 lines of text and one of names, then three columns; `values` in gal."""
    return "\n".join([*head("AFAD", *values), *joined(values, "13.6f")]) + "\n"


def jma(values: Sequence[Array]) -> str:
    """7 lines, then three columns, each with empty fields behind it; `values` in gal."""
    return "".join(f"{line},,,,,\n" for line in (*head("JMA", *values), *joined(values, ".3f", ",")))


def knet_csv(values: Sequence[Array]) -> str:
    """Labels over their values behind "#", then two times and a column a sensor; `values` in gal about an offset.

    The layout of files downloaded from NIED, as four readers of them agree; six columns are a borehole of KiK-net.
    """
    names = ",".join(f"{name}(gal)" for name in (("N-S", "E-W", "U-D") if len(values) == 3 else range(1, 7)))
    heading = [
        "#K-NET CSV", "#Event", "#OriginTime,Latitude,Longitude,Depth(km),Magnitude",
        "#1999/01/02 03:04:00,38.1,142.9,24,6.0", "#Station", "#Code,Latitude,Longitude,Height(m)",
        "#TST001,38.7,141.0,40", "#Record", "#SamplingFrequency(Hz)", f"#{1 / STEP:.0f}", "#DurationTime(s)",
        f"#{len(values[0]) * STEP:g}", "#Offset", f"#{names}", "#" + ",".join(["-18.60"] * len(values)),
        f"#Time,RelativeTime(s),{names}",
    ]  # fmt: skip
    rows_ = (
        ",".join([f"1999/01/02 03:04:26.{k % 100:02d}", f"{STEP * k:.3f}", *(f"{x - 18.6:.4f}" for x in row)])
        for k, row in enumerate(zip(*values, strict=True))
    )
    return "\n".join([*heading, *rows_]) + "\n"


def asa(values: Sequence[Array]) -> str:
    """A header of keys in Spanish, then a column a channel; `values` in gal."""
    return "\n".join([*head("ASA", *values), *joined(values, "12.5f")]) + "\n"


def csmnc(values: Array, component: str = "EW") -> str:
    """16 lines, then 8 numbers in a line; `values` in cm/s2."""
    lines = rows([f"{v:14.6E}" for v in values], 8)
    return "\n".join([*head("CSMNC", values, direction=component), *lines]) + "\n"


def columns(values: Sequence[Array], *, mark: str = ",", comma: bool = False, heading: str = "") -> str:
    """Time and values."""
    lines = []
    for k, row in enumerate(np.column_stack(values).tolist()):
        line = mark.join([f"{STEP * k:.3f}", *(f"{v:.7f}" for v in row)])
        lines.append(line.replace(".", ",") if comma else line)
    return "\n".join([heading, *lines] if heading else lines) + "\n"


@dataclass(frozen=True)
class Written:
    """A file of the first component, or of two or three, and how it is read."""

    format: str
    digits: float  #: largest error of its print [m/s2]
    text: Callable[[Array, Array, Array], str]  #: of accelerations in m/s2
    components: int = 1
    _: KW_ONLY
    unit: str | None = None  #: that the reader must be told
    sample_interval: float | None = None
    centred: bool = False  #: the mean is subtracted


def in_gal(write: Callable[[Sequence[Array]], str]) -> Callable[[Array, Array, Array], str]:
    """A writer of three components in cm/s2."""
    return lambda *components: write([100.0 * one for one in components])


#: one of each family and form
WRITTEN = {
    "PEER": Written("PEER", 1e-6, lambda a, b, c: peer(a / G)),
    "PEER, old header": Written("PEER", 1e-6, lambda a, b, c: peer(a / G, old=True)),
    "PEER, blanks": Written(
        "PEER",
        1e-6,
        lambda a, b, c: "\n".join([*peer(a / G).split("\n")[:4], *(f"{v / G:.7f}" for v in a)]),
    ),
    "ESM": Written("ESM ASCII", 1e-8, lambda a, b, c: esm(100.0 * a)),
    "K-NET": Written("K-NET", 4e-6, lambda a, b, c: knet(100.0 * a), centred=True),
    "SMC": Written("SMC", 1e-7, lambda a, b, c: smc(100.0 * a)),
    "COSMOS": Written("COSMOS", 1e-7, lambda a, b, c: cosmos([(100.0 * a, 90), (100.0 * c, 400)]), 2),
    "COSMOS in g": Written(
        "COSMOS", 6e-5, lambda a, b, c: cosmos([(a / G, 90)], code=2, unit="g", volume="Uncorrected")
    ),
    "CSMIP V2": Written(
        "CSMIP", 1e-7, lambda a, b, c: csmip_v2([(100.0 * a, "90 Deg"), (100.0 * c, "Up")]), 2
    ),
    "CSMIP V1": Written("CSMIP", 6e-6, lambda a, b, c: csmip_v1([(a / G, "90 Deg"), (c / G, "Up")]), 2),
    "AFAD": Written("AFAD", 1e-8, in_gal(afad), 3),
    "JMA": Written("JMA CSV", 5e-6, in_gal(jma), 3),
    "K-NET CSV": Written(
        "K-NET",
        1e-6,
        lambda *parts: knet_csv([100.0 * one[: parts[0].size] for one in parts]),
        3,
        centred=True,
    ),
    "ASA": Written("ASA", 1e-7, in_gal(asa), 3),
    "CSMNC": Written("CSMNC", 1e-5, lambda a, b, c: csmnc(100.0 * a)),
    "count and interval": Written(
        "PEER",
        1e-7,
        lambda a, b, c: f"a title\n{len(a)} {STEP}\n" + "\n".join(rows([f"{v:12.7f}" for v in a], 8)),
        unit="m/s2",
    ),
    "one column": Written(
        "columns", 1e-7, lambda a, b, c: "".join(f"{v:.7f}\n" for v in a), unit="m/s2", sample_interval=STEP
    ),
    "two columns": Written("columns", 1e-7, lambda a, b, c: columns([a]), unit="m/s2"),
    "three columns": Written("columns", 1e-7, lambda a, b, c: columns([a, c]), 2, unit="m/s2"),
    "Excel": Written(
        "columns",
        1e-7,
        lambda a, b, c: columns([a, c], mark=";", comma=True, heading="Zeit [s];H [m/s²];V [m/s²]"),
        2,
    ),
}
