"""What an earlier version had: options, commands, tables and keys, and what to use in place of each.

Whoever still has one in a script or a file is told so in one sentence.
"""

#: an option, or one of a command alone; a table in brackets; a key behind its table
LEFT = {
    "--slurm": "start workers with dask-jobqueue and give the address of their scheduler with --scheduler",
    "--shard": "give the address of a dask scheduler with --scheduler; its workers share the runs",
    "--merge": "give the address of a dask scheduler with --scheduler; the result lies in one folder",
    "batch --site": "verify each container with assess, by a site file that names it",
    "batch --strict": "a bad row has its reason in the list, on the screen and on the page",
    "response --limit-slip": "the slip of each point is in response.csv",
    "movie --width": "a movie is as wide as a picture; any program for films scales it",
    "report --all-variations": "run --band varies the unknown inputs, run --margin the strength of the motion",
    "tie.to_height_m": "ties run to the floor or to a wall; tie each container of a row to one of these",
    "support.casting_bears": "castings touch with their outer edges; wide plates are feet (support.kind)",
    "support.casting_tilt_m": "castings are level; uncertainty.restitution_over_housner varies how an impact lands",
    "uncertainty.casting_tilt_m": "castings are level; restitution_over_housner varies how an impact lands",
    "[hazard]": "estimate the fragility with `python -m fem ensemble` and integrate it over your hazard curve",
    ".margin": "take the strength as an axis with [threshold], or `python -m fem batch --margins all`",
    ".copy_motions": "sets of up to 100 motions are copied into the results",
    "motions.scatter": "it was part of [hazard]; leave it out",
    "fem.annual_rate": "integrate your fragility curve over your hazard curve",
} | dict.fromkeys(
    [f"response --{name}" for name in ("order", "scale", "tolerance", "largest-period")],
    "frequencies are evenly spaced, up and then down, and judged with the settings that were usual",
)


def left_words(name: str) -> str:
    """What to say behind the name of what left; empty where it did not."""
    return f"is no longer there; {LEFT[name]}" if name in LEFT else ""
