"""Arrays on the stack of a kernel."""

import numpy as np

from contact.jit import compiled
from contact.local_arrays import local_counts, local_row, local_rows, part_row, part_rows


@compiled
def work_on_parts(given, rows, counts):
    numbers, table, whole = local_row(6), local_rows(2, 3), local_counts(2)
    for i in range(6):
        numbers[i] += given[i]
    part_row(numbers, 1, 2)[1] = -1.0
    last = part_rows(numbers, 2, 2, 2)
    for i in range(2):
        whole[i] += last.shape[i]
        for k in range(2):
            table[i, k] += last[i, k]
    for i in range(2):
        counts[i] = whole[i]
        for k in range(3):
            rows[i, k] = table[i, k]


def test_parts_share_the_memory_of_their_array_and_all_begin_at_zero():
    for _ in range(2):  # nothing is left of the call before
        rows, counts = np.full((2, 3), np.nan), np.zeros(2, dtype=np.int64)
        work_on_parts(np.arange(6.0), rows, counts)
        assert rows.tolist() == [[-1.0, 3.0, 0.0], [4.0, 5.0, 0.0]]
        assert counts.tolist() == [2, 2]
