"""`list`: the shipped cases, sweeps and ensembles."""

from fem.case_files import DEFAULT_CASE, shipped_cases, shipped_description
from fem.ensemble.shipped import SHIPPED_ENSEMBLES, shipped_ensemble_description
from fem.sweep.shipped import SHIPPED_SWEEPS, shipped_sweep_description


def list_cases() -> None:
    """Print the name of every shipped case, sweep and ensemble and what it shows."""
    width = max(len(name) for name in (*shipped_cases(), *SHIPPED_SWEEPS, *SHIPPED_ENSEMBLES))
    for name in shipped_cases():
        mark = " (default)" if name == DEFAULT_CASE else ""
        print(f"{name:{width}}  {shipped_description(name)}{mark}")
    print("\nSweeps, many cases each:")
    for name in SHIPPED_SWEEPS:
        print(f"{name:{width}}  {shipped_sweep_description(name)}")
    print("\nEnsembles, what nobody knows beforehand drawn many times:")
    for name in SHIPPED_ENSEMBLES:
        print(f"{name:{width}}  {shipped_ensemble_description(name)}")
    print(
        "\npython -m fem run NAME computes a case, python -m fem sweep NAME a sweep, "
        "python -m fem ensemble NAME an ensemble; python -m fem init NAME writes any of them to a file."
    )
