"""Long-time motion under a harmonic drive: response curves, phase portraits, Poincare sections, stability."""
