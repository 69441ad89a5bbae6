/* What the parts of the solver share: types, sizes, sums over unknowns.

   The library's own source includes, in this order: its configuration, its kernels, this header, the equations of the
   scene, one of linear_dense.c and linear_blocks.c, and the parts of the solver: solver_newton.c, solver_path.c, solver.c,
   solver_sensitivity.c, solver_track.c, solver_recover.c but for tubes. All is one translation unit, so that nothing but
   the functions of the library's header is visible to a linker. */
#ifndef SOLVER_UNKNOWNS
#error "This file is a part of the library's own source: compile that one."
#endif
#if defined(__FAST_MATH__) || (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "The solver looks for values that are not finite: compile without -ffast-math."
#endif

#include <math.h>
#include <string.h>

typedef solver_real real;
typedef solver_jacobian_factors jacobian_factors;
typedef solver_updated_jacobian updated_jacobian;
typedef solver_path_point path_point;
typedef solver_workspace workspace;

enum {
  N = SOLVER_UNKNOWNS,
  INPUTS = SOLVER_INPUTS,
  POSES = SOLVER_POSES,
  MAX_REUSES = SOLVER_MAX_REUSES,
  POSE_SIZE = 7 /* position and quaternion */
};

#ifdef SOLVER_SINGLE
#define SQUARE_ROOT sqrtf
#define ABSOLUTE fabsf
#else
#define SQUARE_ROOT sqrt
#define ABSOLUTE fabs
#endif

/* Arguments of the residual besides the unknowns. */
typedef struct {
  const real *inputs;
  real load_factor;
} loads;

static loads full_load(const real *inputs) {
  const loads full = {inputs, 1};
  return full;
}

/* Four independent sums run in parallel. */
static real dot(const real *a, const real *b) {
  real sums[4] = {0, 0, 0, 0};
  int i = 0;
  for (; i + 4 <= N; i += 4) {
    sums[0] += a[i] * b[i];
    sums[1] += a[i + 1] * b[i + 1];
    sums[2] += a[i + 2] * b[i + 2];
    sums[3] += a[i + 3] * b[i + 3];
  }
  for (; i < N; i++) sums[0] += a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

static real norm_of(const real *a) { return SQUARE_ROOT(dot(a, a)); }

/* The result is not a number if an entry is not finite. Four independent sums run in parallel. */
static int all_finite(const real *a, int count) {
  real sums[4] = {0, 0, 0, 0};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    sums[0] += a[i] * 0;
    sums[1] += a[i + 1] * 0;
    sums[2] += a[i + 2] * 0;
    sums[3] += a[i + 3] * 0;
  }
  for (; i < count; i++) sums[0] += a[i] * 0;
  return (sums[0] + sums[1]) + (sums[2] + sums[3]) == 0;
}

/* ---- Newton ---- */

typedef struct {
  solver_status status;
  int iterations;
  int jacobians;
  int damped;
  real residual_norm; /* relative: over one plus the norm of the unknowns */
} newton_result;

/* Limits of Newton's method: when it gives up; length of the next step below which it stops before the tolerance, 0 for
   never; whether it begins with the present Jacobian. */
typedef struct {
  int max_iterations;
  int max_jacobians;
  int max_halvings;
  real inexact;
  int reuse_jacobian;
} newton_limits;

/* State of Newton's method at an iterate. */
typedef struct {
  newton_result result;
  int reuse_jacobian;
  real norm; /* of the residual */
} newton_state;

/* ---- Continuation ---- */

/* From the unloaded scene under growing loads, or from some inputs to others; t from 0 to 1. */
typedef struct {
  int grows_load;
  int is_paced; /* by the shape alone */
  const real *from;
  const real *to;
} load_path;

typedef struct {
  int max_steps;
  int max_iterations;
  real first_step; /* share of the path; zero for the default */
} path_limits;

/* State of a continuation: the last two points and room for the next one, the Jacobian of the last point and room for
   another. */
typedef struct {
  path_point *point;
  path_point *previous; /* null at the first point */
  path_point *next;
  path_point *spare_point;
  updated_jacobian *jacobian;
  updated_jacobian *spare;
  int has_jacobian;
  int is_paced;
  real step; /* next step; zero if none is long enough */
} progress;
