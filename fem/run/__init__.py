"""One run: stepping to the end, recording, checkpoints, band over unknown inputs, files. It knows no set of runs."""
