"""Values between the ends of a step."""

from contact.jit import compiled


@compiled
def hermite(share: float, step: float, value: float, rate: float, value_new: float, rate_new: float) -> float:
    """Cubic through values and rates at both ends of a step, at `share` of it."""
    s = share
    return (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * value
        + s * (1.0 - s) ** 2 * step * rate
        + s * s * (3.0 - 2.0 * s) * value_new
        - s * s * (1.0 - s) * step * rate_new
    )
