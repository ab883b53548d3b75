"""What is known of a run before it is computed, for `check` and `run --dry-run`. Nothing here loads a kernel."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from contact.interface.penalty import contact_frequency
from fem.case.case import Case
from fem.case.columns import history_columns
from fem.case.tables.duration import ends_at_rest
from fem.model.floor_numbers import floor_result
from fem.model.frames import frame_bytes, frame_interval
from fem.model.geometry import build_container, node_count
from fem.model.link_places import require_room
from fem.model.restitution import contact_restitution, require_loss
from fem.model.static_checks import StaticChecks, static_checks_of
from fem.model.support import build_support, normal_penalty
from fem.model.validity import require_bearing, require_memory, require_stiff_contact
from fem.results.disk import BYTES_BESIDE, in_units, table_bytes
from fem.results.run_result import FloorNumbers, MotionResult
from fem.run.described import code_note, doubts
from fem.run.words import paragraphs
from mesh.container import ContainerMesh

#: model, step and scheme of most runs; weight over walls times stiffness, for one element, that squeezes no container
PLAIN = {(model, "auto", "generalised-alpha") for model in ("rigid", "reduced")}
SMALL_STRAIN = 0.01


@dataclass(frozen=True, kw_only=True)
class Preview:
    """A case with its mesh, before its run."""

    case: Case
    mesh: ContainerMesh
    motion: MotionResult
    duration: float  #: simulated time, at most [s]

    @property
    def stands_plainly(self) -> bool:
        """Whether nothing at the start can refuse a run: a stiff container, upright on two points of a level floor.

        A box alone, no vertical motion, the usual step and scheme. Two points carry less than `require_bearing` asks.
        """
        case, box, solver = self.case, self.case.container, self.case.solver
        walls = float(self.mesh.thickness.min()) * solver.element_size_m * box.youngs_modulus_Pa
        return (
            case.support.kind == "corners"
            and build_support(case, self.mesh).index.size == 2
            and case.initial.rotation_rad == case.initial.angular_velocity_rad_s == 0.0
            and case.floor.slope_percent == 0.0
            and case.vertical.kind == "none"
            and not (case.neighbour or case.links or box.is_loose or box.eccentricity_m)
            and (solver.model, solver.step_s, solver.scheme) in PLAIN
            and (solver.model == "rigid" or self.mesh.mass * case.gravity_m_s2 < SMALL_STRAIN * walls)
        )

    @property
    def peak(self) -> float:
        """Largest |acceleration| that the floor reaches in the run [m/s2]."""
        return self.motion.peak_in_run_m_s2 or 0.0

    @property
    def vertical_peak(self) -> float | None:
        """Largest |acceleration| of the floor upward or downward in the run; None without such a motion [m/s2]."""
        return None if self.motion.vertical is None else self.motion.vertical.peak_in_run_m_s2

    @cached_property
    def static(self) -> StaticChecks:
        """Static checks of the container under its own motion."""
        return static_checks_of(self.case, self.mesh, self.peak, self.vertical_peak)

    @property
    def derived(self) -> dict[str, float | None]:
        """What follows from the case before anything moves; SI units stand in the keys."""
        case, mesh, harmonic = self.case, self.mesh, self.case.motion.kind == "harmonic"
        return {
            "mass_kg": mesh.mass,
            "box_mass_kg": case.box_mass,
            "mean_areal_density_kg_m2": case.mass / sum(box.width * box.height for box in case.stack),
            "width_m": mesh.width,
            "height_m": mesh.height,
            "peak_floor_acceleration_m_s2": self.peak,
            "amplitude_m": case.motion.amplitude if harmonic else None,
            "angular_frequency_rad_s": case.motion.angular_frequency if harmonic else None,
            "period_s": case.motion.period if harmonic else None,
        }

    @cached_property
    def numerics(self) -> dict[str, Any]:
        """Model, scheme and sizes of the computation.

        Raises:
            CaseError: the contact is too soft to carry the container.
        """
        case, mesh, solver = self.case, self.mesh, self.case.solver
        nodes = node_count(mesh, solver.order)
        penalty = normal_penalty(case, mesh)
        springs = build_support(case, mesh).normal_stiffness(penalty)
        require_memory(case, nodes, springs.size)
        stiffness = float(springs.sum())
        require_stiff_contact(case, mesh, stiffness)
        require_loss(case, self.static)
        for neighbour in case.row[1:]:
            require_loss(neighbour, static_checks_of(neighbour, build_container(neighbour), 0.0))
        require_bearing(case, mesh)
        require_room(case, mesh)
        return {
            "model": solver.model,
            "scheme": solver.scheme,
            "elements": len(mesh.quads),
            "nodes": nodes,
            "mesh_unknowns": 2 * nodes,
            "elastic_modes": {"rigid": 0, "reduced": solver.elastic_modes}.get(solver.model),
            "contact_nodes": len(springs),
            "normal_penalty_Pa_m": None if case.floor.is_slab else penalty,
            "contact_damping_ratio": self.floor.damping_ratio or case.contact.damping_ratio,
            "contact_frequency_Hz": contact_frequency(mesh.mass, stiffness),
            "static_penetration_m": mesh.mass * case.gravity_m_s2 / stiffness,
            "duration_s": self.duration,
            "ends_at_rest": ends_at_rest(case),
            "history_samples": samples_of(case, self.duration),
            "field_frames": frames_of(case, nodes, self.duration),
            "output_bytes": required_disk(case, nodes, self.duration),
        }

    @cached_property
    def floor(self) -> FloorNumbers:
        """What the floor amounts to; of a rigid one its slope alone."""
        return floor_result(self.case, self.mesh, self.static) or FloorNumbers(kind="rigid")

    @property
    def notes(self) -> list[str]:
        """What to keep in mind when the run is read."""
        return paragraphs(
            "notes.txt.j2",
            case=self.case,
            static=self.static,
            peak=self.peak,
            code_note=code_note(self.static.to_result()),
            doubts=doubts(self.motion, self.case),
            kicks=[
                motion.amplitude * motion.angular_frequency * abs(math.cos(motion.phase_rad))
                for motion in (self.case.motion, self.case.vertical)
            ],
        )

    def to_json(self) -> dict[str, Any]:
        """Everything but the hash of the case, as JSON types."""
        return {
            "derived": self.derived,
            "motion": self.motion.to_json(),
            "floor": self.floor.to_json(),
            "static": self.static.to_result().to_json(),
            "contact_restitution": contact_restitution(self.case, self.static),
            "numerics": self.numerics,
            "notes": self.notes,
        }


BYTES_OF_A_CHECKPOINT_NODE = 500.0


def samples_of(case: Case, duration: float) -> int:
    """Rows of the history of a run of this duration [s]."""
    return math.floor(duration / case.output.history_s * (1.0 + 1e-12)) + 1


def frames_of(case: Case, nodes: int, duration: float) -> int:
    """Frames of a run of this duration [s]; `nodes` of the elements."""
    interval = frame_interval(case, nodes, duration)
    return math.floor(duration / interval * (1.0 + 1e-12)) + 1 if interval else 0


def required_disk(case: Case, nodes: int, duration: float) -> float:
    """Size of the folder of a run of this duration [s], in bytes; `nodes` of the elements."""
    history = table_bytes(samples_of(case, duration), len(history_columns(case)))
    frames = frame_bytes(nodes) * frames_of(case, nodes, duration)
    return history + frames + BYTES_OF_A_CHECKPOINT_NODE * nodes + BYTES_BESIDE


def size_in_words(case: Case, nodes: int, duration: float) -> str:
    """The run and what takes most of its space, for a refusal."""
    frames = f"{frames_of(case, nodes, duration)} frames of {in_units(frame_bytes(nodes))}"
    return f"the run ({frames}, {samples_of(case, duration)} rows of history)"
