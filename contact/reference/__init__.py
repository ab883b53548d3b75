"""Analytic references: event-driven blocks and closed forms. They share no code with the other packages."""
