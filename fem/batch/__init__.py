"""Many cases on many cores: runner, workers, axes, expressions. It knows neither sweep nor ensemble."""
