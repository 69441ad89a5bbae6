/* Names, sizes and limits with which the solver and its headers are compiled for nitinol_wire. */
#include "nitinol_wire.h"

#define solver_real nitinol_wire_real
#define solver_status nitinol_wire_status
#define solver_info nitinol_wire_info
#define solver_options nitinol_wire_options
#define solver_jacobian_factors nitinol_wire_jacobian_factors
#define solver_updated_jacobian nitinol_wire_updated_jacobian
#define solver_path_point nitinol_wire_path_point
#define solver_workspace nitinol_wire_workspace
#define solver_memory nitinol_wire_memory
#define solver_solve nitinol_wire_solve
#define solver_follow nitinol_wire_follow
#define solver_solve_sensitivity nitinol_wire_solve_sensitivity
#define solver_track nitinol_wire_track
#define solver_recover nitinol_wire_recover
#define solver_residual nitinol_wire_residual
#define solver_residual_jacobian nitinol_wire_residual_jacobian
#define solver_input_jacobian nitinol_wire_input_jacobian

#define SOLVER_CONVERGED NITINOL_WIRE_CONVERGED
#define SOLVER_MAX_ITERATIONS NITINOL_WIRE_MAX_ITERATIONS
#define SOLVER_NOT_FINITE NITINOL_WIRE_NOT_FINITE
#define SOLVER_SINGULAR NITINOL_WIRE_SINGULAR
#define SOLVER_LOAD_STALLED NITINOL_WIRE_LOAD_STALLED
#define SOLVER_UNRESOLVED NITINOL_WIRE_UNRESOLVED
#define SOLVER_NOT_IN_EQUILIBRIUM NITINOL_WIRE_NOT_IN_EQUILIBRIUM
#define SOLVER_LOST_TRACK NITINOL_WIRE_LOST_TRACK
#define SOLVER_PATH_VANISHED NITINOL_WIRE_PATH_VANISHED
#define SOLVER_BEYOND_MATERIAL NITINOL_WIRE_BEYOND_MATERIAL
#define SOLVER_OUT_OF_PLANE NITINOL_WIRE_OUT_OF_PLANE

#define SOLVER_UNKNOWNS NITINOL_WIRE_UNKNOWNS
#define SOLVER_INPUTS NITINOL_WIRE_INPUTS
#define SOLVER_POSES NITINOL_WIRE_POSES
#define SOLVER_MAX_REUSES 12

#define SOLVER_DEFAULT_ITERATIONS 40
#define SOLVER_DEFAULT_CONTINUATION_STEPS 20
#define SOLVER_SETTLING_ITERATIONS 4

#ifdef NITINOL_WIRE_SINGLE
#define SOLVER_SINGLE
static const nitinol_wire_real TOLERANCE = (nitinol_wire_real)1e-5;
static const nitinol_wire_real MIN_STEP = (nitinol_wire_real)1e-4;
static const nitinol_wire_real SINGULAR = (nitinol_wire_real)1e-7;
#else
static const nitinol_wire_real TOLERANCE = (nitinol_wire_real)1e-11;
static const nitinol_wire_real MIN_STEP = (nitinol_wire_real)1e-07;
static const nitinol_wire_real SINGULAR = (nitinol_wire_real)1e-11;
#endif
enum {
  MAX_ITERATIONS = 60,     /* of one Newton */
  MAX_HALVINGS = 12,
  MAX_STEPS = 400,         /* of one continuation */
  GROW_BELOW = 2,          /* Jacobians of a correction up to which the next step grows */
  REJECT_ABOVE = 4         /* Jacobians of a correction beyond which its step is refused */
};
static const nitinol_wire_real SUFFICIENT_DECREASE = (nitinol_wire_real)0.0001;
static const nitinol_wire_real REUSE_DECREASE = (nitinol_wire_real)0.5;
static const nitinol_wire_real MAX_STEP_LENGTH = (nitinol_wire_real)4.0;
static const nitinol_wire_real INEXACT = (nitinol_wire_real)0.01;
static const nitinol_wire_real MAX_CURVATURE_SHARE = (nitinol_wire_real)0.5;
static const nitinol_wire_real FIRST_STEP = (nitinol_wire_real)1.0;
static const nitinol_wire_real SAME_BRANCH = (nitinol_wire_real)0.5;
#define solver_error_estimate nitinol_wire_error_estimate
#define SOLVER_MISSING 9
