/* Names, sizes and limits with which the solver and its headers are compiled for follower_reissner. */
#include "follower_reissner.h"

#define solver_real follower_reissner_real
#define solver_status follower_reissner_status
#define solver_info follower_reissner_info
#define solver_options follower_reissner_options
#define solver_jacobian_factors follower_reissner_jacobian_factors
#define solver_updated_jacobian follower_reissner_updated_jacobian
#define solver_path_point follower_reissner_path_point
#define solver_workspace follower_reissner_workspace
#define solver_memory follower_reissner_memory
#define solver_solve follower_reissner_solve
#define solver_follow follower_reissner_follow
#define solver_solve_sensitivity follower_reissner_solve_sensitivity
#define solver_track follower_reissner_track
#define solver_recover follower_reissner_recover
#define solver_residual follower_reissner_residual
#define solver_residual_jacobian follower_reissner_residual_jacobian
#define solver_input_jacobian follower_reissner_input_jacobian

#define SOLVER_CONVERGED FOLLOWER_REISSNER_CONVERGED
#define SOLVER_MAX_ITERATIONS FOLLOWER_REISSNER_MAX_ITERATIONS
#define SOLVER_NOT_FINITE FOLLOWER_REISSNER_NOT_FINITE
#define SOLVER_SINGULAR FOLLOWER_REISSNER_SINGULAR
#define SOLVER_LOAD_STALLED FOLLOWER_REISSNER_LOAD_STALLED
#define SOLVER_UNRESOLVED FOLLOWER_REISSNER_UNRESOLVED
#define SOLVER_NOT_IN_EQUILIBRIUM FOLLOWER_REISSNER_NOT_IN_EQUILIBRIUM
#define SOLVER_LOST_TRACK FOLLOWER_REISSNER_LOST_TRACK
#define SOLVER_PATH_VANISHED FOLLOWER_REISSNER_PATH_VANISHED
#define SOLVER_BEYOND_MATERIAL FOLLOWER_REISSNER_BEYOND_MATERIAL
#define SOLVER_OUT_OF_PLANE FOLLOWER_REISSNER_OUT_OF_PLANE

#define SOLVER_UNKNOWNS FOLLOWER_REISSNER_UNKNOWNS
#define SOLVER_INPUTS FOLLOWER_REISSNER_INPUTS
#define SOLVER_POSES FOLLOWER_REISSNER_POSES
#define SOLVER_MAX_REUSES 12

#define SOLVER_DEFAULT_ITERATIONS 40
#define SOLVER_DEFAULT_CONTINUATION_STEPS 20
#define SOLVER_SETTLING_ITERATIONS 4

#ifdef FOLLOWER_REISSNER_SINGLE
#define SOLVER_SINGLE
static const follower_reissner_real TOLERANCE = (follower_reissner_real)1e-5;
static const follower_reissner_real MIN_STEP = (follower_reissner_real)1e-4;
static const follower_reissner_real SINGULAR = (follower_reissner_real)1e-7;
#else
static const follower_reissner_real TOLERANCE = (follower_reissner_real)1e-11;
static const follower_reissner_real MIN_STEP = (follower_reissner_real)1e-07;
static const follower_reissner_real SINGULAR = (follower_reissner_real)1e-11;
#endif
enum {
  MAX_ITERATIONS = 60,     /* of one Newton */
  MAX_HALVINGS = 12,
  MAX_STEPS = 400,         /* of one continuation */
  GROW_BELOW = 2,          /* Jacobians of a correction up to which the next step grows */
  REJECT_ABOVE = 4         /* Jacobians of a correction beyond which its step is refused */
};
static const follower_reissner_real SUFFICIENT_DECREASE = (follower_reissner_real)0.0001;
static const follower_reissner_real REUSE_DECREASE = (follower_reissner_real)0.5;
static const follower_reissner_real MAX_STEP_LENGTH = (follower_reissner_real)4.0;
static const follower_reissner_real INEXACT = (follower_reissner_real)0.01;
static const follower_reissner_real MAX_CURVATURE_SHARE = (follower_reissner_real)0.5;
static const follower_reissner_real FIRST_STEP = (follower_reissner_real)1.0;
static const follower_reissner_real SAME_BRANCH = (follower_reissner_real)0.5;
#define solver_error_estimate follower_reissner_error_estimate
#define SOLVER_MISSING 18
