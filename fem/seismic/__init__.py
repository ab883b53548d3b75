"""The seismic action at a site and motions that represent it, as numbers; it knows no case and no run."""
