/* Names, sizes and limits with which the solver and its headers are compiled for tendon_robot. */
#include "tendon_robot.h"

#define solver_real tendon_robot_real
#define solver_status tendon_robot_status
#define solver_info tendon_robot_info
#define solver_options tendon_robot_options
#define solver_jacobian_factors tendon_robot_jacobian_factors
#define solver_updated_jacobian tendon_robot_updated_jacobian
#define solver_path_point tendon_robot_path_point
#define solver_workspace tendon_robot_workspace
#define solver_memory tendon_robot_memory
#define solver_solve tendon_robot_solve
#define solver_follow tendon_robot_follow
#define solver_solve_sensitivity tendon_robot_solve_sensitivity
#define solver_track tendon_robot_track
#define solver_recover tendon_robot_recover
#define solver_residual tendon_robot_residual
#define solver_residual_jacobian tendon_robot_residual_jacobian
#define solver_input_jacobian tendon_robot_input_jacobian

#define SOLVER_CONVERGED TENDON_ROBOT_CONVERGED
#define SOLVER_MAX_ITERATIONS TENDON_ROBOT_MAX_ITERATIONS
#define SOLVER_NOT_FINITE TENDON_ROBOT_NOT_FINITE
#define SOLVER_SINGULAR TENDON_ROBOT_SINGULAR
#define SOLVER_LOAD_STALLED TENDON_ROBOT_LOAD_STALLED
#define SOLVER_UNRESOLVED TENDON_ROBOT_UNRESOLVED
#define SOLVER_NOT_IN_EQUILIBRIUM TENDON_ROBOT_NOT_IN_EQUILIBRIUM
#define SOLVER_LOST_TRACK TENDON_ROBOT_LOST_TRACK
#define SOLVER_PATH_VANISHED TENDON_ROBOT_PATH_VANISHED
#define SOLVER_BEYOND_MATERIAL TENDON_ROBOT_BEYOND_MATERIAL
#define SOLVER_OUT_OF_PLANE TENDON_ROBOT_OUT_OF_PLANE

#define SOLVER_UNKNOWNS TENDON_ROBOT_UNKNOWNS
#define SOLVER_INPUTS TENDON_ROBOT_INPUTS
#define SOLVER_POSES TENDON_ROBOT_POSES
#define SOLVER_MAX_REUSES 12

#define SOLVER_DEFAULT_ITERATIONS 40
#define SOLVER_DEFAULT_CONTINUATION_STEPS 20
#define SOLVER_SETTLING_ITERATIONS 4

#ifdef TENDON_ROBOT_SINGLE
#define SOLVER_SINGLE
static const tendon_robot_real TOLERANCE = (tendon_robot_real)1e-5;
static const tendon_robot_real MIN_STEP = (tendon_robot_real)1e-4;
static const tendon_robot_real SINGULAR = (tendon_robot_real)1e-7;
#else
static const tendon_robot_real TOLERANCE = (tendon_robot_real)1e-11;
static const tendon_robot_real MIN_STEP = (tendon_robot_real)1e-07;
static const tendon_robot_real SINGULAR = (tendon_robot_real)1e-11;
#endif
enum {
  MAX_ITERATIONS = 60,     /* of one Newton */
  MAX_HALVINGS = 12,
  MAX_STEPS = 400,         /* of one continuation */
  GROW_BELOW = 2,          /* Jacobians of a correction up to which the next step grows */
  REJECT_ABOVE = 4         /* Jacobians of a correction beyond which its step is refused */
};
static const tendon_robot_real SUFFICIENT_DECREASE = (tendon_robot_real)0.0001;
static const tendon_robot_real REUSE_DECREASE = (tendon_robot_real)0.5;
static const tendon_robot_real MAX_STEP_LENGTH = (tendon_robot_real)4.0;
static const tendon_robot_real INEXACT = (tendon_robot_real)0.01;
static const tendon_robot_real MAX_CURVATURE_SHARE = (tendon_robot_real)0.5;
static const tendon_robot_real FIRST_STEP = (tendon_robot_real)1.0;
static const tendon_robot_real SAME_BRANCH = (tendon_robot_real)0.5;
#define solver_error_estimate tendon_robot_error_estimate
#define SOLVER_MISSING 18
