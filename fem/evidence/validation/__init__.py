"""Laboratory experiments predicted by the program: measurements, fits, predictions; no command, no study."""
