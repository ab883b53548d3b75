"""`list`: the shipped cases, sweeps and ensembles."""

from fem.case.files import CASES, DEFAULT_CASE, ENSEMBLES, SWEEPS


def list_cases() -> None:
    """Print the name of every shipped case, sweep and ensemble and what it shows."""
    width = max(len(name) for name in (*CASES.names, *SWEEPS.names, *ENSEMBLES.names))
    for name in CASES.names:
        mark = " (default)" if name == DEFAULT_CASE else ""
        print(f"{name:{width}}  {CASES.description(name)}{mark}")
    print("\nSweeps, many cases each:")
    for name in SWEEPS.names:
        print(f"{name:{width}}  {SWEEPS.description(name)}")
    print("\nEnsembles, what nobody knows beforehand drawn many times:")
    for name in ENSEMBLES.names:
        print(f"{name:{width}}  {ENSEMBLES.description(name)}")
    print(
        "\npython -m fem run NAME computes a case, python -m fem sweep NAME a sweep, "
        "python -m fem ensemble NAME an ensemble; python -m fem init NAME writes any of them to a file."
    )
