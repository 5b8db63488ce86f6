//! Codes of findings that somebody looks for: whoever makes such a finding, and whoever asks for it, names it here. A
//! code that nothing asks for stands where its finding is made; those of the screening are rows of `screening::Cause`.

/// Code of the finding about names and values that stand in the first row of a group alone.
pub const CARRIED_DOWN: &str = "carried-down";
/// Code of the finding about two joints that the readings hardly tell apart.
pub const CORRELATED: &str = "correlated";
/// Code of the finding about measured forces of another size than the load's.
pub const FORCE_MAGNITUDE: &str = "force-magnitude";
/// Code of the finding about a term of the model that the residuals ask for.
pub const FURTHER_TERM: &str = "further-term";
/// Code of the finding about a given transform that the unloaded readings contradict.
pub const GIVEN_REGISTRATION: &str = "given-registration";
/// Code of the finding about rows and columns of a worksheet that are hidden and count.
pub const HIDDEN_CELLS: &str = "hidden-cells";
/// Code of the finding about measuring points that the tracker does not see.
pub const HIDDEN_POINTS: &str = "hidden-points";
/// Code of the finding about readings that repeat another to the last digit.
pub const IDENTICAL_READINGS: &str = "identical-readings";
/// Code of the finding about a joint that the load of a cell leaves out.
pub const JOINT_LEFT_OUT: &str = "joint-left-out";
/// Code of the finding about a measured wrench that acts beside the stated loading point.
pub const LOADING_POINT: &str = "loading-point";
/// Code of the finding about forces that stand in the names of states alone.
pub const LOADS_FROM_NAMES: &str = "loads-from-names";
/// Code of the finding about displacements that do not grow in proportion to the load.
pub const LOAD_OFFSET: &str = "load-offset";
/// Code of the finding about merged cells, each row of which has the value of the first.
pub const MERGED_CELLS: &str = "merged-cells";
/// Code of the finding about more contradictions than single readings can explain.
pub const MORE_OUTLIERS: &str = "more-outliers";
/// Code of the finding about moves of a route in a cell without shapes.
pub const MOVES_NOT_CHECKED: &str = "moves-not-checked";
/// Code of the finding about a move without a free way.
pub const MOVE_BLOCKED: &str = "move-blocked";
/// Code of the finding about readings that a sheet names, row by row.
pub const NAMES_BY_SHEET: &str = "names-by-sheet";
/// Code of the finding about a joint that yields against its torque.
pub const NEGATIVE_COMPLIANCE: &str = "negative-compliance";
/// Code of the finding.
pub const NEVER_LOADED: &str = "never-loaded";
/// Code of the finding about a region of which no node can be reached.
pub const NOTHING_REACHABLE: &str = "nothing-reachable";
/// Code of the finding about rows that are not filled in yet.
pub const NOT_MEASURED_YET: &str = "not-measured-yet";
/// Code of the finding about a path that fits nowhere on the grid of places.
pub const NOWHERE: &str = "nowhere";
/// Code of the finding about postures with no more room than the cell asks for.
pub const NO_ROOM_TO_SPARE: &str = "no-room-to-spare";
/// Code of the finding about it.
pub const ONE_LOAD: &str = "one-load";
/// Code of the finding about postures on the machine's limit of a joint.
pub const ON_MACHINE_LIMIT: &str = "on-machine-limit";
/// Code of the finding about a displacement that contradicts the others.
pub const OUTLYING_DISPLACEMENT: &str = "outlying-displacement";
/// Code of the finding about a measuring point that contradicts the others.
pub const OUTLYING_POINT: &str = "outlying-point";
/// Code of the finding about a posture that contradicts the others.
pub const OUTLYING_POSTURE: &str = "outlying-posture";
/// Code of the finding about displacements outside the bands of their calculation.
pub const OUTSIDE_BANDS: &str = "outside-bands";
/// Code of the finding about a posture that bounds or limits forbid.
pub const POSTURE_FORBIDDEN: &str = "posture-forbidden";
/// Code of the finding about a joint that a single posture determines.
pub const POSTURE_NEEDED: &str = "posture-needed";
/// Code of the finding about given postures outside bounds or limits.
pub const POSTURE_OUTSIDE: &str = "posture-outside";
/// Code of the finding about the step in which readings were written down.
pub const READING_RESOLUTION: &str = "reading-resolution";
/// Code of the finding about a posture that the registration leaves out.
pub const REGISTRATION_OUTLIER: &str = "registration-outlier";
/// Code of the finding about unloaded readings that the model does not meet.
pub const REGISTRATION_RESIDUAL: &str = "registration-residual";
/// Code of the finding about residuals larger than the stated noise.
pub const RESIDUALS_ABOVE_NOISE: &str = "residuals-above-noise";
/// Code of the finding about residuals too few to test against the noise.
pub const RESIDUALS_UNTESTED: &str = "residuals-untested";
/// Code of the finding about rows below the readings that are none: remarks, means.
pub const ROWS_LEFT_OUT: &str = "rows-left-out";
/// Code of the finding about postures of a validation that the identification has seen.
pub const SEEN_POSTURES: &str = "seen-postures";
/// Code of the finding about a quantity of the set-up that is rejected.
pub const SET_UP: &str = "set-up";
/// Code of the finding about a quantity of the set-up that is in doubt.
pub const SET_UP_DOUBTFUL: &str = "set-up-doubtful";
/// Code of the finding about a start that touches something.
pub const START_TOUCHES: &str = "start-touches";
/// Code of the finding about a stiffness that cannot be right.
pub const STIFFNESS_DOUBTFUL: &str = "stiffness-doubtful";
/// Code of the finding about measured moments that no loading point explains.
pub const UNEXPLAINED_MOMENT: &str = "unexplained-moment";
/// Code of the finding about a joint that the postures do not load.
pub const UNLOADED_JOINT: &str = "unloaded-joint";
/// Code of the finding about a joint of a URDF that is a gripper's.
pub const URDF_GRIPPER: &str = "urdf-gripper";
/// Code of the finding about a joint that the postures hardly load.
pub const WEAK_JOINT: &str = "weak-joint";
