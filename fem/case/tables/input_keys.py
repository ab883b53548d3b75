"""The dotted keys of the inputs that a case may not know."""

MU_KINETIC, WEAKENING, STRIBECK = "contact.mu_kinetic", "contact.weakening_m", "contact.stribeck_velocity_m_s"
#: between loose boxes
JOINTS_MU_STATIC, JOINTS_MU_KINETIC = "joints.mu_static", "joints.mu_kinetic"
JOINTS_WEAKENING, JOINTS_DASHPOT = "joints.weakening_m", "joints.damping_ratio"
MU_STATIC, SUPPORT = "contact.mu_static", "support.kind"
CENTROID, ECCENTRICITY = "container.centroid_m", "container.eccentricity_m"
EFFECTIVE, SLOPE, VERTICAL_PHASE = "support.effective_width", "floor.slope_percent", "vertical.phase_rad"
PHASE, VERTICAL_SIGN = "motion.phase_rad", "vertical.scale"
#: of a record, of one that is scaled to a peak, of a pulse
SIGNS = "motion.scale", "motion.scale_to_m_s2", "motion.peak_acceleration_m_s2"
START, RAMP, TOLERANCE = "motion.start", "motion.ramp_cycles", "solver.energy_tolerance"
PENALTY, DASHPOT, RESTITUTION, MATERIAL = (
    "contact.normal_penalty_Pa_m",
    "contact.damping_ratio",
    "contact.restitution_over_housner",
    "container.damping_ratio",
)
FILL = "container.fill_damping_ratio"
CAMBER, ROCKING = "support.camber_m", "support.rocking_damping_ratio"
STOP_GAP, STOP_STIFFNESS, STOP_FRICTION = "stop.gap_m", "stop.stiffness_N_m", "stop.mu"
TIE_SLACK, TIE_STIFFNESS = "tie.slack_m", "tie.stiffness_N_m"
SIDE_GAP, SIDE_STIFFNESS, SIDE_FRICTION = "neighbour.gap_m", "neighbour.stiffness_N_m", "neighbour.mu"
STRENGTH, MODULUS = "floor.bearing_strength_Pa", "floor.youngs_modulus_Pa"
