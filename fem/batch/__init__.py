"""Many cases on all cores: the engine, its workers and log, axes and expressions. It knows no kind of study."""
