/* Names, sizes and limits with which the solver and its headers are compiled for planar_strip. */
#include "planar_strip.h"

#define solver_real planar_strip_real
#define solver_status planar_strip_status
#define solver_info planar_strip_info
#define solver_options planar_strip_options
#define solver_jacobian_factors planar_strip_jacobian_factors
#define solver_updated_jacobian planar_strip_updated_jacobian
#define solver_path_point planar_strip_path_point
#define solver_workspace planar_strip_workspace
#define solver_memory planar_strip_memory
#define solver_solve planar_strip_solve
#define solver_follow planar_strip_follow
#define solver_solve_sensitivity planar_strip_solve_sensitivity
#define solver_track planar_strip_track
#define solver_recover planar_strip_recover
#define solver_residual planar_strip_residual
#define solver_residual_jacobian planar_strip_residual_jacobian
#define solver_input_jacobian planar_strip_input_jacobian

#define SOLVER_CONVERGED PLANAR_STRIP_CONVERGED
#define SOLVER_MAX_ITERATIONS PLANAR_STRIP_MAX_ITERATIONS
#define SOLVER_NOT_FINITE PLANAR_STRIP_NOT_FINITE
#define SOLVER_SINGULAR PLANAR_STRIP_SINGULAR
#define SOLVER_LOAD_STALLED PLANAR_STRIP_LOAD_STALLED
#define SOLVER_UNRESOLVED PLANAR_STRIP_UNRESOLVED
#define SOLVER_NOT_IN_EQUILIBRIUM PLANAR_STRIP_NOT_IN_EQUILIBRIUM
#define SOLVER_LOST_TRACK PLANAR_STRIP_LOST_TRACK
#define SOLVER_PATH_VANISHED PLANAR_STRIP_PATH_VANISHED
#define SOLVER_BEYOND_MATERIAL PLANAR_STRIP_BEYOND_MATERIAL
#define SOLVER_OUT_OF_PLANE PLANAR_STRIP_OUT_OF_PLANE

#define SOLVER_UNKNOWNS PLANAR_STRIP_UNKNOWNS
#define SOLVER_INPUTS PLANAR_STRIP_INPUTS
#define SOLVER_POSES PLANAR_STRIP_POSES
#define SOLVER_MAX_REUSES 12

#define SOLVER_DEFAULT_ITERATIONS 40
#define SOLVER_DEFAULT_CONTINUATION_STEPS 20
#define SOLVER_SETTLING_ITERATIONS 4

#ifdef PLANAR_STRIP_SINGLE
#define SOLVER_SINGLE
static const planar_strip_real TOLERANCE = (planar_strip_real)1e-5;
static const planar_strip_real MIN_STEP = (planar_strip_real)1e-4;
static const planar_strip_real SINGULAR = (planar_strip_real)1e-7;
#else
static const planar_strip_real TOLERANCE = (planar_strip_real)1e-11;
static const planar_strip_real MIN_STEP = (planar_strip_real)1e-07;
static const planar_strip_real SINGULAR = (planar_strip_real)1e-11;
#endif
enum {
  MAX_ITERATIONS = 60,     /* of one Newton */
  MAX_HALVINGS = 12,
  MAX_STEPS = 400,         /* of one continuation */
  GROW_BELOW = 2,          /* Jacobians of a correction up to which the next step grows */
  REJECT_ABOVE = 4         /* Jacobians of a correction beyond which its step is refused */
};
static const planar_strip_real SUFFICIENT_DECREASE = (planar_strip_real)0.0001;
static const planar_strip_real REUSE_DECREASE = (planar_strip_real)0.5;
static const planar_strip_real MAX_STEP_LENGTH = (planar_strip_real)4.0;
static const planar_strip_real INEXACT = (planar_strip_real)0.01;
static const planar_strip_real MAX_CURVATURE_SHARE = (planar_strip_real)0.5;
static const planar_strip_real FIRST_STEP = (planar_strip_real)1.0;
static const planar_strip_real SAME_BRANCH = (planar_strip_real)0.5;
#define solver_error_estimate planar_strip_error_estimate
#define SOLVER_MISSING 3
