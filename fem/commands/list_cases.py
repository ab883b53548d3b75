"""`list`: the shipped cases and sweeps."""

from fem.case_files import DEFAULT_CASE, shipped_cases, shipped_description
from fem.sweep.shipped import SHIPPED_SWEEPS, shipped_sweep_description


def list_cases() -> None:
    """Print the name of every shipped case and sweep and what it shows."""
    width = max(len(name) for name in (*shipped_cases(), *SHIPPED_SWEEPS))
    for name in shipped_cases():
        mark = " (default)" if name == DEFAULT_CASE else ""
        print(f"{name:{width}}  {shipped_description(name)}{mark}")
    print("\nSweeps, many cases each:")
    for name in SHIPPED_SWEEPS:
        print(f"{name:{width}}  {shipped_sweep_description(name)}")
    print(
        "\npython -m fem run NAME computes a case, python -m fem sweep NAME a sweep; "
        "python -m fem init NAME writes either to a file."
    )
