"""One run: stepping to the end, recording, checkpoints, band over what is not known, files. It knows no set of runs."""
