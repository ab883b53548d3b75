"""The motion of a run on its page: animation and curves."""

from fem.html import sections as html
from fem.html.units import quantity, short
from fem.report.animation import COLOURS, colour_scale, exaggeration, exaggerations
from fem.report.run_view import RunView

#: figures beside the animation, in the order of reading; the others have their own sections
MOTION = ("rotation", "slip", "base_motion", "spectrum", "uplift", "forces", "phase_portrait", "energy")
SHORT_MOTION = ("rotation", "slip")
KEYS = (
    "Space or k plays and pauses, comma and full stop go by a sample, j and l by 0.1 s; a click on a curve goes to its "
    "instant."
)


def motion_section(view: RunView) -> html.PageSection:
    """The animation and the curves beside it."""
    moves = view.case.motion.kind != "none" or view.case.has_vertical
    names = SHORT_MOTION if view.brief else MOTION
    curves = view.figures(*(name for name in names if name != "base_motion" or moves))
    if not curves:
        return html.section("The motion", "motion-title", "There are no samples to show.")
    player = [_player(view)] if view.played else []
    motion = html.Group("motion brief" if view.brief else "motion", [*player, html.Group("curves", curves)])
    return html.section("The motion", "motion-title", motion)


def _player(view: RunView) -> html.Player:
    animation, height = view.animation, view.model.container.mesh.height
    chosen = exaggeration(animation, height)
    return html.Player(
        f"{_what_is_played(view)} Red: normal force, blue: friction, on the container; dashed: where it first stood on "
        f"the floor; ○: mass centre{' of each box' if view.boxes else ''}; ▲: where the middle of its base first was"
        f"{f'; {view.note_on_level}' if view.note_on_level else ''}. {KEYS}",
        loose=bool(view.boxes),
        exaggerations=[
            html.Choice(factor, f"× {short(factor)}", factor == chosen)
            for factor in exaggerations(animation, height)
        ],
        meshed=bool(animation.frames),
        legend=_legend(view),
    )


def _what_is_played(view: RunView) -> str:
    animation, every = view.animation, f"every {short(view.played['step'], 1000)} ms"
    if animation.stress_scale:
        largest = quantity(animation.largest_stress, "MPa", 1e-6, 3)
        return (
            f"The rigid motion follows the history ({every}); deformation and stress follow "
            f"{len(animation.frames)} frames and are interpolated between them. Largest stress in the frames: "
            f"{largest}, in one place; 98 % of the values lie within the scale."
        )
    if animation.frames:
        rigid = "The boxes are rigid: they have" if view.boxes else "The container is rigid: it has"
        forces = f"the contact forces {len(animation.frames)} frames"
        return f"The motion follows the history ({every}), {forces}. {rigid} no stress."
    return "No fields were written: the container is shown without deformation."


def _legend(view: RunView) -> html.Legend | None:
    """The colours of the stress, where there is any."""
    if not view.animation.stress_scale:
        return None
    most = quantity(view.animation.stress_scale, "MPa", 1e-6, 3)
    return html.Legend("von Mises stress 0", f"{most} and more", colour_scale("YlGnBu", COLOURS))
