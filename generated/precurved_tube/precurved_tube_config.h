/* Names, sizes and limits with which the solver and its headers are compiled for precurved_tube. */
#include "precurved_tube.h"

#define solver_real precurved_tube_real
#define solver_status precurved_tube_status
#define solver_info precurved_tube_info
#define solver_options precurved_tube_options
#define solver_jacobian_factors precurved_tube_jacobian_factors
#define solver_updated_jacobian precurved_tube_updated_jacobian
#define solver_path_point precurved_tube_path_point
#define solver_workspace precurved_tube_workspace
#define solver_memory precurved_tube_memory
#define solver_solve precurved_tube_solve
#define solver_follow precurved_tube_follow
#define solver_solve_sensitivity precurved_tube_solve_sensitivity
#define solver_track precurved_tube_track
#define solver_recover precurved_tube_recover
#define solver_residual precurved_tube_residual
#define solver_residual_jacobian precurved_tube_residual_jacobian
#define solver_input_jacobian precurved_tube_input_jacobian

#define SOLVER_CONVERGED PRECURVED_TUBE_CONVERGED
#define SOLVER_MAX_ITERATIONS PRECURVED_TUBE_MAX_ITERATIONS
#define SOLVER_NOT_FINITE PRECURVED_TUBE_NOT_FINITE
#define SOLVER_SINGULAR PRECURVED_TUBE_SINGULAR
#define SOLVER_LOAD_STALLED PRECURVED_TUBE_LOAD_STALLED
#define SOLVER_UNRESOLVED PRECURVED_TUBE_UNRESOLVED
#define SOLVER_NOT_IN_EQUILIBRIUM PRECURVED_TUBE_NOT_IN_EQUILIBRIUM
#define SOLVER_LOST_TRACK PRECURVED_TUBE_LOST_TRACK
#define SOLVER_PATH_VANISHED PRECURVED_TUBE_PATH_VANISHED
#define SOLVER_BEYOND_MATERIAL PRECURVED_TUBE_BEYOND_MATERIAL
#define SOLVER_OUT_OF_PLANE PRECURVED_TUBE_OUT_OF_PLANE

#define SOLVER_UNKNOWNS PRECURVED_TUBE_UNKNOWNS
#define SOLVER_INPUTS PRECURVED_TUBE_INPUTS
#define SOLVER_POSES PRECURVED_TUBE_POSES
#define SOLVER_MAX_REUSES 12

#define SOLVER_DEFAULT_ITERATIONS 40
#define SOLVER_DEFAULT_CONTINUATION_STEPS 20
#define SOLVER_SETTLING_ITERATIONS 4

#ifdef PRECURVED_TUBE_SINGLE
#define SOLVER_SINGLE
static const precurved_tube_real TOLERANCE = (precurved_tube_real)1e-5;
static const precurved_tube_real MIN_STEP = (precurved_tube_real)1e-4;
static const precurved_tube_real SINGULAR = (precurved_tube_real)1e-7;
#else
static const precurved_tube_real TOLERANCE = (precurved_tube_real)1e-11;
static const precurved_tube_real MIN_STEP = (precurved_tube_real)1e-07;
static const precurved_tube_real SINGULAR = (precurved_tube_real)1e-11;
#endif
enum {
  MAX_ITERATIONS = 60,     /* of one Newton */
  MAX_HALVINGS = 12,
  MAX_STEPS = 400,         /* of one continuation */
  GROW_BELOW = 2,          /* Jacobians of a correction up to which the next step grows */
  REJECT_ABOVE = 4         /* Jacobians of a correction beyond which its step is refused */
};
static const precurved_tube_real SUFFICIENT_DECREASE = (precurved_tube_real)0.0001;
static const precurved_tube_real REUSE_DECREASE = (precurved_tube_real)0.5;
static const precurved_tube_real MAX_STEP_LENGTH = (precurved_tube_real)4.0;
static const precurved_tube_real INEXACT = (precurved_tube_real)0.01;
static const precurved_tube_real MAX_CURVATURE_SHARE = (precurved_tube_real)0.5;
static const precurved_tube_real FIRST_STEP = (precurved_tube_real)1.0;
static const precurved_tube_real SAME_BRANCH = (precurved_tube_real)0.5;
#define solver_error_estimate precurved_tube_error_estimate
#define SOLVER_MISSING 9
