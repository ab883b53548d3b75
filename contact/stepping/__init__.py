"""Time stepping of a body on its contact: scheme, step control, observables, ledger. It knows no mesh and no case."""
