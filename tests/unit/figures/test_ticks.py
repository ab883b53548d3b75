"""Ticks of the axes of figures: those of matplotlib, which states the rules."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from fem.figures.plotting import house_style
from fem.figures.scale import Scale


def test_places_and_labels_are_those_of_matplotlib():
    generator = np.random.default_rng(1)
    with house_style():
        for _ in range(300):
            height = generator.uniform(0.3, 3.0)  # inch
            low = generator.choice([0.0, generator.normal() * 10.0 ** generator.uniform(-7.0, 7.0)])
            high = low + max(10.0 ** generator.uniform(-7.0, 7.0), 0.02 * abs(low))
            axes = Figure(figsize=(7.0, 4.0)).add_axes((0.1, 0.1, 0.8, height / 4.0))
            axes.set_ylim(low, high)
            places, labels = axes.yaxis.get_majorticklocs(), axes.yaxis.get_ticklabels()
            slack = 1e-10 * (high - low)
            theirs = [
                (place, label.get_text())
                for place, label in zip(places, labels, strict=True)
                if low - slack <= place <= high + slack
            ]
            scale = Scale(extent=72.0 * height, aspect=2.0, margin=0.05, limits=(low, high))
            ours, _, power = scale.ticks()
            assert [label for _, label in ours] == [label for _, label in theirs], (low, high, height)
            assert [place for place, _ in ours] == pytest.approx([place for place, _ in theirs])
            assert power == axes.yaxis.get_major_formatter().get_offset()


def test_a_logarithmic_axis_has_ticks_at_powers_of_ten():
    scale = Scale(extent=400.0, aspect=3.0, margin=0.0, limits=(0.02, 4.0), logarithmic=True)
    ticks, smaller, _ = scale.ticks()
    assert [place for place, _ in ticks] == pytest.approx([0.1, 1.0])
    assert smaller.tolist() == pytest.approx([*np.arange(2, 10) / 100, *np.arange(2, 10) / 10, 2.0, 3.0, 4.0])
    assert scale.share(np.array([0.02, 0.2, 4.0])) == pytest.approx([0.0, np.log(10.0) / np.log(200.0), 1.0])
