"""Reading a motion file of 60,000 samples in every format, CPU time of the best of three."""

import sys
import tempfile
import time
from pathlib import Path

from measuring import Figure, at_most, report

sys.path.append(str(Path(__file__).parents[1] / "fuzz"))

from record_files import WRITTEN, Written, synthetic_motion

from fem.records.files import read_record

SAMPLES, REPEATS = 60_000, 3
READING = 0.3  # s


def seconds(path: Path, form: Written) -> float:
    """CPU time of one reading [s]; a new time of the file, so that it is not taken from memory."""
    spent = []
    for _ in range(REPEATS):
        path.touch()
        began = time.process_time()
        read_record(path, unit=form.unit, sample_interval=form.sample_interval)
        spent.append(time.process_time() - began)
    return min(spent)


def main() -> int:
    motion = synthetic_motion(SAMPLES)
    figures: list[Figure] = []
    with tempfile.TemporaryDirectory() as folder:
        for name, form in WRITTEN.items():
            path = Path(folder) / "motion"
            path.write_text(form.text(*motion))
            size = path.stat().st_size / 1e6
            figures.append(
                at_most(
                    f"{name}, {form.components} x {SAMPLES}, {size:.1f} MB [s]", seconds(path, form), READING
                )
            )
    return report("reading motion files, CPU time", figures)


if __name__ == "__main__":
    sys.exit(main())
