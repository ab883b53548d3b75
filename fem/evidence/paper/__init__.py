"""The paper by Knoedel and Hrabowski, claim by claim: runs, figures, conclusions. Nothing depends on it."""
