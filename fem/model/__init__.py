"""From a case to a model ready to step: container, support, motion, equilibrium, static checks. It takes no step."""
