"""Motion files in every format that is read, written here from one synthetic motion of three components.

Accelerations are given in m/s2; each writer converts them to the unit of its format and prints its digits.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

G = 9.80665
STEP = 0.005
Array = NDArray[np.float64]


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
    keys = {
        "EVENT_NAME": "NOWHERE",
        "EVENT_ID": "XX-1999-0001",
        "EVENT_DATE_YYYYMMDD": "19990102",
        "STATION_CODE": "TST",
        "VS30_M/S": "",
        "SAMPLING_INTERVAL_S": f"{STEP:.6f}",
        "NDATA": str(len(values)),
        "UNITS": unit,
        "STREAM": stream,
        "INSTRUMENT_ANALOG/DIGITAL": "D",
        "PGA_CM/S^2": f"{np.abs(values).max():.6f}",
        "DATA_TYPE": data_type,
    }
    keys |= {f"USER{k}": "" for k in range(64 - len(keys))}
    return (
        "\n".join([*(f"{key}: {value}" for key, value in keys.items()), *(f"{v:.6f}" for v in values)]) + "\n"
    )


def knet(values: Array, direction: str = "N-S", *, offset: int = 12345) -> str:
    """17 lines, then 8 counts of 9 columns in a line; `values` in gal; a number of samples that is whole seconds."""
    counts = np.rint(values * 6182761 / 3920).astype(int) + offset
    labels = {
        "Origin Time": "1999/01/02 03:04:00", "Lat.": "38.1", "Long.": "142.9", "Depth. (km)": "24", "Mag.": "6.0",
        "Station Code": "TST001", "Station Lat.": "38.7", "Station Long.": "141.0", "Station Height(m)": "40",
        "Record Time": "1999/01/02 03:04:26", "Sampling Freq(Hz)": f"{1 / STEP:.0f}Hz",
        "Duration Time(s)": f"{len(values) * STEP:g}", "Dir.": direction, "Scale Factor": "3920(gal)/6182761",
        "Max. Acc. (gal)": f"{np.abs(values).max():.3f}", "Last Correction": "1999/01/02 03:04:11", "Memo.": "",
    }  # fmt: skip
    heading = [f"{label:<18}{value}" for label, value in labels.items()]
    return "\n".join([*heading, *rows([f"{count:9d}" for count in counts], 8)]) + "\n"


def smc(values: Array, component: str = "90", *, title: str = "2 CORRECTED ACCELEROGRAM") -> str:
    """11 lines of text, 48 whole numbers, 50 reals, two comments, 8 numbers of 10 columns; `values` in cm/s2."""
    whole = [-32768] * 48
    whole[15], whole[16], whole[17] = 2, len(values), 0
    real = [1.7e38] * 50
    real[1] = 1.0 / STEP
    text = [title, "*", "TST", "1999 01 02", "", f"station = Nowhere      component= {component}", *["*"] * 5]
    return (
        "\n".join(
            [
                *text,
                *rows([f"{n:10d}" for n in whole], 8),
                *rows([f"{r:15.7E}" for r in real], 5),
                "| a comment",
                "| another",
                *rows([f"{v:10.5f}" for v in values], 8),
            ]
        )
        + "\n"
    )


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
            f"{volume} acceleration    (Format v01.20 with 13 text lines) Src: nowhere",
            "Record of the quake that was not", "Hypocenter: To be determined", "Origin: To be determined",
            "Statn No: 05- 99999 Code:XX-99999  Nowhere", "Coords: 38.0  -122.0", "Recorder: none",
            "Rcrd start time: 1/02/1999, 03:04:05.0 UTC", f"Sta Chan  {number}: {direction} deg (Rcrdr Chan  {number})",
            "Raw record length =", "Processed:", "Record filtered", "Values used when unknown:   -999, -999.0",
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
        text += [
            f"Corrected accelerogram   99999-X       Chan  {number}:  {direction:<8}   from",
            "Uncorrected Accelerogram Data             Processed: 01/02/99", "Rcrd of Sat Jan  2, 1999",
            "Preliminary Processing", "99999-X       Start time:  1/02/99", "Station No. 99999   37.0N, 122.0W",
            "Nowhere", f"Chan  {number}:  {direction:<8}                  Location: Ground",
            f" {len(values)} points of instrument- and baseline-corrected accel, veloc and displ data",
            "At equally-spaced intervals of   0.005  sec.", *["some text"] * 15,
            *rows([f"{-999:5d}"] * 100, 16), *rows([f"{-999.0:10.5f}"] * 100, 8),
        ]  # fmt: skip
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
            "Uncorrected Accelerogram Data             Processed: 01/02/99", "Rcrd of Sat Jan  2, 1999", "a", "b",
            "Station No. 99999   37.0N, 122.0W", "Nowhere", f"Chan  {number}:  {direction}", *["some text"] * 6,
            *rows([f"{-999:5d}"] * 100, 16), *rows([f"{-999.0:10.5f}"] * 50, 8),
            f" {len(values)} Accelerogram points at 200 pts/sec in units of g. Format: (8f9.6)",
            *rows([f"{v:9.6f}"[:9] for v in values], 8),
            f"/&  ----------  End of data for channel {number:2d}  ----------",
        ]  # fmt: skip
    return "\n".join(text) + "\n"


def afad(values: Sequence[Array]) -> str:
    """17 lines of text and one of names, then three columns; `values` in gal."""
    names = ("N-S", "E-W", "U-D")
    peaks = " ".join(f"({name}) {np.abs(v).max():.6f}" for name, v in zip(names, values, strict=True))
    keys = {
        "PLACE": "NOWHERE", "EARTHQUAKE DATE": "1999/01/02 03:04:05 (GMT)", "EPICENTER COORDINATES": "36.9N-27.4E",
        "EARTHQUAKE DEPTH (km)": "19.44", "EARTHQUAKE MAGNITUDE": "6.5 Mw", "STATION ID": "9999",
        "STATION COORDINATES": "37.2N-28.3E", "STATION ALTITUDE (m)": "638", "RECORDER TYPE": "none",
        "RECORDER SERIAL NO": "5C20", "RECORD TIME": "02/01/1999 03:04:14.000000 (GMT)",
        "NUMBER OF DATA": str(len(values[0])), "SAMPLING INTERVAL (sec)": f"{STEP:g}", "RAW PGA VALUES (gal)": peaks,
    }  # fmt: skip
    heading = [
        "STRONG GROUND MOTION RECORDS OF TURKIYE",
        *(f"{key:<24}: {value}" for key, value in keys.items()),
    ]
    heading += ["Copyright NOBODY", "NOWHERE", "       N-S          E-W          U-D"]
    return (
        "\n".join([*heading, *("".join(f"{x:13.6f}" for x in row) for row in zip(*values, strict=True))])
        + "\n"
    )


def jma(values: Sequence[Array]) -> str:
    """7 lines, then three columns, each with empty fields behind it; `values` in gal."""
    heading = [
        "SITE CODE= 99999 Nowhere,37.5,137.2,16,7.6", " LAT.=   37.0000", " LON.=  137.0000",
        f" SAMPLING RATE= {1 / STEP:.0f}Hz", " UNIT  = gal(cm/s/s)", "INITIAL TIME = 1999 01 02 03 04 05", " NS,EW,UD",
    ]  # fmt: skip
    rows_ = (",".join(f"{x:.3f}" for x in row) for row in zip(*values, strict=True))
    return "".join(f"{line},,,,,\n" for line in (*heading, *rows_))


def knet_csv(values: Sequence[Array]) -> str:
    """The labels of K-NET with commas, then a time and three columns; `values` in gal."""
    heading = [
        "Origin Time,1999/01/02 03:04:00", "Lat.,38.1", "Long.,142.9", "Station Code,TST001",
        f"Sampling Freq(Hz),{1 / STEP:.0f}Hz", f"Duration Time(s),{len(values[0]) * STEP:g}",
        f"Max. Acc. (gal),{max(np.abs(v).max() for v in values):.3f}", "Time(s),NS(gal),EW(gal),UD(gal)",
    ]  # fmt: skip
    rows_ = (
        ",".join([f"{STEP * k:.3f}", *(f"{x:.4f}" for x in row)])
        for k, row in enumerate(zip(*values, strict=True))
    )
    return "\n".join([*heading, *rows_]) + "\n"


def asa(values: Sequence[Array]) -> str:
    """A header of keys in Spanish, then a column a channel; `values` in gal."""
    peaks = "/".join(f"{np.abs(v).max():.2f}" for v in values)
    heading = [
        "=" * 80, "1. NOMBRE DEL ARCHIVO", "", "FORMATO: ARCHIVO ESTANDAR DE ACELERACION (ASA 2.0)", "=" * 80,
        "NOMBRE DE LA ESTACION                 : NOWHERE", "CLAVE DE LA ESTACION                  : TST1",
        "NUMERO DE CANALES                     : 3", "ORIENTACION C1-C6 (rumbo;orientacion) : /N90E;L/N00E;T/V;+/",
        "VEL. DE MUESTREO, C1-C6 (muestras/s)  : /200/200/200/",
        f"INTERVALO DE MUESTREO, C1-C6 (s)      : /{STEP}/{STEP}/{STEP}/",
        "HORA EPICENTRO (GMT)                  : 03:04:05.6", "FECHA DEL SISMO [GMT]                 : 1999/01/02",
        f"NUM. TOTAL DE MUESTRAS, C1-C6         : /{len(values[0])}/{len(values[0])}/{len(values[0])}/",
        f"ACEL. MAX.(Gal), C1-C6                : /{peaks}/", "ACEL. MAX. C1-C6, EN LA MUESTRA       : /1/2/3/",
        "UNIDADES DE LOS DATOS                 : Gal (cm/s/s)", "FACTOR DE DECIMACION                  : 1",
        "COMENTARIOS", "none", "=" * 80, "   CANAL 1    CANAL 2    CANAL 3", "-" * 40,
    ]  # fmt: skip
    return (
        "\n".join([*heading, *("".join(f"{x:12.5f}" for x in row) for row in zip(*values, strict=True))])
        + "\n"
    )


def csmnc(values: Array, component: str = "EW") -> str:
    """16 lines, then 8 numbers in a line; `values` in cm/s2."""
    heading = [
        "051TST990102030405", "0199010203040 1999-01-02 03:04:05 BTM", "NOWHERE EARTHQUAKE, NOWHERE",
        "EPICENTER  30.300N 103.000E DEPTH 13 KM", "MAGNITUDE  7.0(Ms)", "STATION: 51TST 30.400N 102.800E",
        "SITE CONDITION: ROCK", "INSTRUMENT TYPE: NONE", "OBSERVING POINT: GROUND", f"COMP. {component}",
        "UNCORRECTED ACCELERATION          UNIT: CM/SEC/SEC",
        f"NO. OF POINTS:  {len(values)}  EQUALLY SPACED INTERVALS OF:  {STEP}  SEC",
        f"PEAK VALUE: {np.abs(values).max():.3f}   AT   1.0 SEC    DURATION:  {len(values) * STEP:g} SEC",
        "PRE-EVENT TIME:  20  SEC", "CSMNC", "",
    ]  # fmt: skip
    return "\n".join([*heading, *rows([f"{v:14.6E}" for v in values], 8)]) + "\n"


def columns(values: Sequence[Array], *, mark: str = ",", comma: bool = False, heading: str = "") -> str:
    """Time and values."""
    lines = []
    for k, row in enumerate(np.column_stack(values).tolist()):
        line = mark.join([f"{STEP * k:.3f}", *(f"{v:.7f}" for v in row)])
        lines.append(line.replace(".", ",") if comma else line)
    return "\n".join([heading, *lines] if heading else lines) + "\n"


@dataclass(frozen=True, kw_only=True)
class Written:
    """A file of the first component, or of two or three, and how it is read."""

    text: Callable[[Array, Array, Array], str]  #: of accelerations in m/s2
    digits: float  #: largest error of its print [m/s2]
    unit: str | None = None  #: that the reader must be told
    sample_interval: float | None = None
    format: str
    centred: bool = False  #: the mean is subtracted
    components: int = 1


#: one of each family and form
WRITTEN = {
    "PEER": Written(text=lambda a, b, c: peer(a / G), digits=1e-6, format="PEER"),
    "PEER, old header": Written(text=lambda a, b, c: peer(a / G, old=True), digits=1e-6, format="PEER"),
    "PEER, blanks": Written(
        text=lambda a, b, c: "\n".join([*peer(a / G).split("\n")[:4], *(f"{v / G:.7f}" for v in a)]),
        digits=1e-6,
        format="PEER",
    ),
    "ESM": Written(text=lambda a, b, c: esm(100.0 * a), digits=1e-8, format="ESM ASCII"),
    "K-NET": Written(text=lambda a, b, c: knet(100.0 * a), digits=4e-6, format="K-NET", centred=True),
    "SMC": Written(text=lambda a, b, c: smc(100.0 * a), digits=1e-7, format="SMC"),
    "COSMOS": Written(
        text=lambda a, b, c: cosmos([(100.0 * a, 90), (100.0 * c, 400)]),
        digits=1e-7,
        format="COSMOS",
        components=2,
    ),
    "COSMOS in g": Written(
        text=lambda a, b, c: cosmos([(a / G, 90)], code=2, unit="g", volume="Uncorrected"),
        digits=6e-5,
        format="COSMOS",
    ),
    "CSMIP V2": Written(
        text=lambda a, b, c: csmip_v2([(100.0 * a, "90 Deg"), (100.0 * c, "Up")]),
        digits=1e-7,
        format="CSMIP",
        components=2,
    ),
    "CSMIP V1": Written(
        text=lambda a, b, c: csmip_v1([(a / G, "90 Deg"), (c / G, "Up")]),
        digits=6e-6,
        format="CSMIP",
        components=2,
    ),
    "AFAD": Written(
        text=lambda a, b, c: afad((100.0 * a, 100.0 * b, 100.0 * c)), digits=1e-8, format="AFAD", components=3
    ),
    "JMA": Written(
        text=lambda a, b, c: jma((100.0 * a, 100.0 * b, 100.0 * c)),
        digits=5e-6,
        format="JMA CSV",
        components=3,
    ),
    "K-NET CSV": Written(
        text=lambda a, b, c: knet_csv((100.0 * a, 100.0 * b, 100.0 * c)),
        digits=1e-6,
        format="columns",
        components=3,
    ),
    "ASA": Written(
        text=lambda a, b, c: asa((100.0 * a, 100.0 * b, 100.0 * c)), digits=1e-7, format="ASA", components=3
    ),
    "CSMNC": Written(text=lambda a, b, c: csmnc(100.0 * a), digits=1e-5, format="CSMNC"),
    "count and interval": Written(
        text=lambda a, b, c: f"a title\n{len(a)} {STEP}\n" + "\n".join(rows([f"{v:12.7f}" for v in a], 8)),
        digits=1e-7,
        unit="m/s2",
        format="PEER",
    ),
    "one column": Written(
        text=lambda a, b, c: "".join(f"{v:.7f}\n" for v in a),
        digits=1e-7,
        unit="m/s2",
        sample_interval=STEP,
        format="columns",
    ),
    "two columns": Written(text=lambda a, b, c: columns([a]), digits=1e-7, unit="m/s2", format="columns"),
    "three columns": Written(
        text=lambda a, b, c: columns([a, c]), digits=1e-7, unit="m/s2", format="columns", components=2
    ),
    "Excel": Written(
        text=lambda a, b, c: columns([a, c], mark=";", comma=True, heading="Zeit [s];H [m/s²];V [m/s²]"),
        digits=1e-7,
        format="columns",
        components=2,
    ),
}
