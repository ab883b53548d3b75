"""`list`: the shipped cases."""

from fem.case_files import DEFAULT_CASE, shipped_cases, shipped_description


def list_cases() -> None:
    """Print the name of every shipped case and what it shows."""
    width = max(len(name) for name in shipped_cases())
    for name in shipped_cases():
        mark = " (default)" if name == DEFAULT_CASE else ""
        print(f"{name:{width}}  {shipped_description(name)}{mark}")
    print("\npython -m fem run NAME computes one, python -m fem init NAME writes it to a file.")
