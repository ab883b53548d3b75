"""The page of a verification at a site, and its figures."""
