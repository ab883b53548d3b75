"""One run: stepping to the end, recording, checkpoints, sensitivity band, files. It knows no set of runs."""
