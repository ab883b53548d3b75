"""Long-time motion under a harmonic drive: response curves, Poincare sections, stability. It knows no sweeps."""
