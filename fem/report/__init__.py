"""Reports: one self-contained page from the folder of a run or of a sweep, to be sent, read and printed."""
