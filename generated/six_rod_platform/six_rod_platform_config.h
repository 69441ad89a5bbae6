/* Names, sizes and limits with which the solver and its headers are compiled for six_rod_platform. */
#include "six_rod_platform.h"

#define solver_real six_rod_platform_real
#define solver_status six_rod_platform_status
#define solver_info six_rod_platform_info
#define solver_options six_rod_platform_options
#define solver_jacobian_factors six_rod_platform_jacobian_factors
#define solver_updated_jacobian six_rod_platform_updated_jacobian
#define solver_path_point six_rod_platform_path_point
#define solver_workspace six_rod_platform_workspace
#define solver_memory six_rod_platform_memory
#define solver_solve six_rod_platform_solve
#define solver_follow six_rod_platform_follow
#define solver_solve_sensitivity six_rod_platform_solve_sensitivity
#define solver_track six_rod_platform_track
#define solver_recover six_rod_platform_recover
#define solver_residual six_rod_platform_residual
#define solver_residual_jacobian six_rod_platform_residual_jacobian
#define solver_input_jacobian six_rod_platform_input_jacobian

#define SOLVER_CONVERGED SIX_ROD_PLATFORM_CONVERGED
#define SOLVER_MAX_ITERATIONS SIX_ROD_PLATFORM_MAX_ITERATIONS
#define SOLVER_NOT_FINITE SIX_ROD_PLATFORM_NOT_FINITE
#define SOLVER_SINGULAR SIX_ROD_PLATFORM_SINGULAR
#define SOLVER_LOAD_STALLED SIX_ROD_PLATFORM_LOAD_STALLED
#define SOLVER_UNRESOLVED SIX_ROD_PLATFORM_UNRESOLVED
#define SOLVER_NOT_IN_EQUILIBRIUM SIX_ROD_PLATFORM_NOT_IN_EQUILIBRIUM
#define SOLVER_LOST_TRACK SIX_ROD_PLATFORM_LOST_TRACK
#define SOLVER_PATH_VANISHED SIX_ROD_PLATFORM_PATH_VANISHED
#define SOLVER_BEYOND_MATERIAL SIX_ROD_PLATFORM_BEYOND_MATERIAL
#define SOLVER_OUT_OF_PLANE SIX_ROD_PLATFORM_OUT_OF_PLANE

#define SOLVER_UNKNOWNS SIX_ROD_PLATFORM_UNKNOWNS
#define SOLVER_INPUTS SIX_ROD_PLATFORM_INPUTS
#define SOLVER_POSES SIX_ROD_PLATFORM_POSES
#define SOLVER_MAX_REUSES 12
#define SOLVER_ENTRIES 2737
#define SOLVER_FRONT_COUNT 6
#define SOLVER_FRONTS_SIZE 4753
#define SOLVER_INTERFACE 7
#define SOLVER_INTERFACE_START 4704
#define SOLVER_MAX_ORDER 28
#define SOLVER_DEFAULT_ITERATIONS 40
#define SOLVER_DEFAULT_CONTINUATION_STEPS 20
#define SOLVER_SETTLING_ITERATIONS 4

#ifdef SIX_ROD_PLATFORM_SINGLE
#define SOLVER_SINGLE
static const six_rod_platform_real TOLERANCE = (six_rod_platform_real)1e-5;
static const six_rod_platform_real MIN_STEP = (six_rod_platform_real)1e-4;
static const six_rod_platform_real SINGULAR = (six_rod_platform_real)1e-7;
#else
static const six_rod_platform_real TOLERANCE = (six_rod_platform_real)1e-11;
static const six_rod_platform_real MIN_STEP = (six_rod_platform_real)1e-07;
static const six_rod_platform_real SINGULAR = (six_rod_platform_real)1e-11;
#endif
enum {
  MAX_ITERATIONS = 60,     /* of one Newton */
  MAX_HALVINGS = 12,
  MAX_STEPS = 400,         /* of one continuation */
  GROW_BELOW = 2,          /* Jacobians of a correction up to which the next step grows */
  REJECT_ABOVE = 4         /* Jacobians of a correction beyond which its step is refused */
};
static const six_rod_platform_real SUFFICIENT_DECREASE = (six_rod_platform_real)0.0001;
static const six_rod_platform_real REUSE_DECREASE = (six_rod_platform_real)0.5;
static const six_rod_platform_real MAX_STEP_LENGTH = (six_rod_platform_real)4.0;
static const six_rod_platform_real INEXACT = (six_rod_platform_real)0.01;
static const six_rod_platform_real MAX_CURVATURE_SHARE = (six_rod_platform_real)0.5;
static const six_rod_platform_real FIRST_STEP = (six_rod_platform_real)0.25;
static const six_rod_platform_real SAME_BRANCH = (six_rod_platform_real)0.5;
#define solver_error_estimate six_rod_platform_error_estimate
#define SOLVER_MISSING 108
