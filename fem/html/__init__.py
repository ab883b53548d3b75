"""Pages: template engine, units in words, templates. It knows no figure and no run."""
