"""Floor motion, contact laws, time stepping with an energy ledger, references. It knows no mesh and no case."""
