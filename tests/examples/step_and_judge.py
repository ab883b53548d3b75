"""Build a model, step it, and judge what it did: the way from a case to a verdict, without files."""

import fem
from fem.model.container import discretise
from fem.model.geometry import build_container
from fem.model.model import build_model
from fem.run.recorder import Recorder
from fem.run.verdict import verdict_of
from fem.solid.nodal_body import advance_body

case = fem.load_case("free_rocking", ["solver.model=rigid", "solver.duration_s=3"])
model = build_model(case, discretise(case, build_container(case)))
recorder = Recorder(model)
for tenth in range(1, 31):
    advance_body(model.body, model.run, tenth / 10.0)
    recorder.drain(model.run)
history = recorder.history()
verdict = verdict_of(model, history, largest_von_mises=None)
print(f"{verdict.outcome}: {verdict.impacts} impacts, the first after {verdict.first_impact_s:.3f} s")
