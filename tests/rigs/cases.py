"""Named cases that many tests begin with, as texts of case files."""

from fem.case.case import Case, load_case, read_case

#: one box at rest, with the keys that must be given and no other
LEAST = """
[container]
width_m = 1.1
height_m = 1.0
weight_N = 24525.0
[contact]
mu_static = 0.4
[motion]
kind = "none"
"""
HARMONIC = LEAST.replace('"none"', '"harmonic"\namplitude_m = 0.05\nangular_frequency_rad_s = 6.928')
PULSE = LEAST.replace('"none"', '"pulse"\nshape = "sine"\npeak_acceleration_m_s2 = -3.0\npulse_s = 0.5')
TABLE = LEAST.replace('"none"', '"table"\nfile = "floor.csv"\nquantity = "acceleration"\nunit = "g"')
#: the stack as one rigid block on a floor at rest, for a moment
BLOCK = """
[container]
width_m = 1.1
height_m = 4.0
density_kg_m3 = 2000.0
[contact]
mu_static = 0.4
[motion]
kind = "none"
[solver]
model = "rigid"
duration_s = 0.05
element_size_m = 2.0
[output]
fields_s = 0.0
figures = false
"""
#: three boxes that differ in size and mass; the mass centre is beside the middle of the base
UNEVEN = HARMONIC.replace(
    "[contact]",
    """[[container.box]]
mass_kg = 2500.0
[[container.box]]
width_m = 0.9
height_m = 0.8
mass_kg = 800.0
offset_m = 0.1
[[container.box]]
width_m = 1.3
mass_kg = 2000.0
offset_m = -0.05
[contact]""",
)
TEXTS = {"least": LEAST, "harmonic": HARMONIC, "pulse": PULSE, "table": TABLE, "uneven": UNEVEN}


def named_case(name: str, overrides: dict[str, object] | None = None) -> Case:
    """A named case with dotted keys set."""
    case = read_case(TEXTS[name]) if name in TEXTS else load_case(name)
    return case.with_values(overrides) if overrides else case
