"""The seed paper, statement by statement: what is tried, what was measured, what follows."""
