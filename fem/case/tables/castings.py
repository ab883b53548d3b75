"""Corner castings below the base: the rules of [support] for them."""

from typing import Any

from fem.case.tables.problem import refused


def _casting_does_not_fit(case: Any) -> str:
    """Why castings do not fit below the base, empty where they do."""
    if case.support.casting_m is None:
        return ""
    width, depth, inset = case.support.casting_m
    if case.support.kind != "corners":
        return f'belongs to support.kind = "corners", got "{case.support.kind}"; leave it out'
    if width <= 0.0 or depth <= 0.0:
        return f"must be [width, depth, inset] with a positive width and depth, got {case.support.casting_m}"
    if case.floor.corner_patch_m is not None:
        return "and floor.corner_patch_m both say what bears under a corner; keep one of them"
    half = 0.5 * case.stack[0].width
    if inset + width > half or 2.0 * depth > case.container.depth_m:
        return (
            f"= {case.support.casting_m} does not fit under the base: inset and width at most half of width_m = "
            f"{half:g} m, two depths at most depth_m = {case.container.depth_m:g} m"
        )
    return ""


CASTING_RULES = (refused("support.casting_m", _casting_does_not_fit),)
