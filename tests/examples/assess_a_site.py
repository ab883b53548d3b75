"""Verify a container at a site by EN 1998-1; here a short set of motions, each computed once."""

from pathlib import Path

import fem

if __name__ == "__main__":
    table = fem.assess_site(Path(__file__).with_name("site.toml"), quick=True)
    print(table.result["answer"])
    print(f"{len(table['outcome'])} runs, slip up to {1e3 * max(table['max_slip_m']):.0f} mm")
