"""Sweep the frequency of the floor up and down: up to where does a box stay at rest?"""

import fem

if __name__ == "__main__":
    case = fem.load_case("seed_box", ["solver.model=rigid"])
    table = fem.compute_response(case, first_Hz=0.5, last_Hz=2.0, count=3, starts=0)
    rests = table["frequency_Hz"][table["motion"] == "rest"]
    print(f"{len(table['motion'])} motions followed; it rests up to {max(rests):.2f} Hz")
