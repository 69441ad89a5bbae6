/* follower_reissner: its equations, and with them the solver, as one translation unit. See follower_reissner.h for what each function does. */
#include "follower_reissner_config.h"

#define casadi_real follower_reissner_real
#define casadi_int int
#include "follower_reissner_kernels.h"

#include "solver.h"

/* Calls of generated kernels: arguments, results, and room as the kernel asks for. */
#define ARGUMENTS(kernel, ...) \
  const real *given[] = {__VA_ARGS__}; \
  const real *arguments[kernel##_SZ_ARG + 1]; \
  real *results[kernel##_SZ_RES + 1]; \
  memcpy(arguments, given, sizeof given)
#define RESULTS(...) \
  { \
    real *const wanted[] = {__VA_ARGS__}; \
    memcpy(results, wanted, sizeof wanted); \
  }
#define CALL(kernel) (void)kernel(arguments, results, work->kernel_integers, work->kernel_reals, 0)
#define CALL_WITHOUT_WORKSPACE(kernel) \
  { \
    int integers[kernel##_SZ_IW + 1]; \
    real reals[kernel##_SZ_W + 1]; \
    (void)kernel(arguments, results, integers, reals, 0); \
  }

/* How much each unknown counts in the length of a step. */
static const real STEP_WEIGHTS[N] = {
  (real)1.0, (real)1.0, (real)1.0, (real)1.0, (real)1.0, (real)1.0, (real)1.0, (real)1.0, (real)1.0, (real)1.0,
  (real)1.0, (real)1.0, (real)1.0};

/* Which unknowns are strains or poses of frames, not multipliers or tensions. */
static const int IS_SHAPE[N] = {1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};

/* Whether load paths that stall nearly loaded are paced. */
enum { PACES = 0, PACE = 3 };
static const real NEARLY_LOADED = (real)0.99;

static void (*const POSE_DERIVATIVES[POSES])(const real *, const real *, real *, real *) = {
    follower_reissner_tip_jacobian,
};

static void residual_at(const real *x, const loads *at, real *residual, workspace *work) {
  ARGUMENTS(follower_reissner_k_residual, x, at->inputs, &at->load_factor);
  RESULTS(residual);
  CALL(follower_reissner_k_residual);
}

static void jacobian_at(const real *x, const loads *at, real *jacobian, workspace *work) {
  ARGUMENTS(follower_reissner_k_jacobian, x, at->inputs, &at->load_factor);
  RESULTS(jacobian);
  CALL(follower_reissner_k_jacobian);
}

static void rate_at(const real *x, const loads *at, const real *inputs_rate, real load_factor_rate, real *rate,
                    workspace *work) {
  ARGUMENTS(follower_reissner_k_rate, x, at->inputs, &at->load_factor, inputs_rate, &load_factor_rate);
  RESULTS(rate);
  CALL(follower_reissner_k_rate);
}

/* dx/d load_factor of the unloaded scene. */
static void unloaded_tangent(const real *inputs, real *tangent, workspace *work) {
  ARGUMENTS(follower_reissner_k_tangent, inputs);
  RESULTS(tangent);
  CALL(follower_reissner_k_tangent);
}

static real resolution_index(const real *x, const real *inputs, workspace *work) {
  real index;
  ARGUMENTS(follower_reissner_k_resolution_index, x, inputs);
  RESULTS(&index);
  CALL(follower_reissner_k_resolution_index);
  return index;
}

/* The scene has no limit of strains. */
static solver_status within_limits(solver_status end, const real *x, const real *inputs, workspace *work) {
  (void)x;
  (void)inputs;
  (void)work;
  return end;
}

/* Nothing is so thin that a step could lead through it. */
#define is_beyond(x, inputs, next, next_inputs, work) ((void)(inputs), 0)
#define is_barred(path, now, work) ((void)(path), 0)

static const real ERROR_SAFETY = (real)1.2;
static const real ERROR_FIRST_LOOK = (real)2.0;
static const real ERROR_SETTLED = (real)0.2;
static const real ERROR_FOLLOWED = (real)0.5;
static const real ERROR_CONTRACTING = (real)0.5;
static const real ERROR_ENOUGH = (real)5e-05;
static const real ERROR_SLOWEST = (real)0.7;
static const real ERROR_WHOLE_TURN = (real)6.283185307179586;
static const real ERROR_UNSEEN = (real)1e-05;
static const real ERROR_FLOOR = (real)2e-14;
enum {
  ERROR_SWEEPS = 4,
  ERROR_BEYOND_TURN = 3,
  MISSING = SOLVER_MISSING,
  STRAINS = 6,
  WATCHED_POSES = 1,
  WATCHED_CABLES = 0,
  WATCHED = POSE_SIZE * WATCHED_POSES + WATCHED_CABLES
};

#include "blind_turns.c"

/* Pairs of degrees: 2 k of strain k for the two highest, 2 k + 1 for the two below; else 2 STRAINS + 1. */
static const int PAIR_OF_UNKNOWN[N] = {13, 13, 13, 1, 13, 13, 13, 3, 5, 13, 7, 9, 11};
static const int PAIR_OF_MISSING[MISSING] = {1, 0, 0, 3, 2, 2, 5, 4, 4, 7, 6, 6, 9, 8, 8, 11, 10, 10};

static const int TURNED_OF_UNKNOWN[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, -1, -1, -1, -1};
static const real TURNED_BY_UNKNOWN[] = {
  (real)0.8192319205190404, (real)0.472983769840402, (real)0.3663716527236558, (real)0.30964056111131616,
  (real)0.8192319205190404, (real)0.472983769840402, (real)0.3663716527236558, (real)0.30964056111131616,
  (real)0.9999999999999999, (real)0.0, (real)0.0, (real)0.0, (real)0.0};
static const real TURNED_UNLOADED[] = {(real)0.0};
static const int TURNED_OF_MISSING[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
static const int TURNED_MODES[] = {7, 7, 7, 7, 7, 7, 4, 4, 4, 5, 5, 5, 4, 4, 4, 4, 4, 4};
static const turned_elements TURNED = {.elements = 1, .unknowns = 13, .missing = 18, .of_unknown = TURNED_OF_UNKNOWN, .by_unknown = TURNED_BY_UNKNOWN, .unloaded = TURNED_UNLOADED, .of_missing = TURNED_OF_MISSING, .modes = TURNED_MODES};

/* Elastic steps of unknowns and missing coordinates at a corrected answer, the residual in the unknowns, and what is
   watched, one behind the other. */
static void richer_balance_at(const real *x, const real *correction, const real *missing, const real *inputs, real *balance,
                              workspace *work) {
  ARGUMENTS(follower_reissner_k_richer_balance, x, correction, missing, inputs);
  RESULTS(balance);
  CALL(follower_reissner_k_richer_balance);
}

/* What is watched: positions over lengths, then quaternions, then lengths of cables over those of their rods. */
static void watched_at(const real *x, const real *inputs, real *watched, workspace *work) {
  ARGUMENTS(follower_reissner_k_watched, x, inputs);
  RESULTS(watched);
  CALL(follower_reissner_k_watched);
}

#include "linear_dense.c"
#include "solver_newton.c"
#include "solver_error.c"
#include "solver_path.c"
#include "solver.c"

/* The Jacobian, factorised, and the derivative of the residual with the inputs where that is not null. Zero where the
   Jacobian is not finite. */
static int linearise_by_inputs(const real *x, const loads *at, jacobian_factors *jacobian, real *d_residual_d_inputs,
                               workspace *work) {
  if (!linearise(x, at, jacobian, work)) return 0;
  if (d_residual_d_inputs && jacobian->regular) input_jacobian_at(x, at, d_residual_d_inputs, work);
  return 1;
}

/* Derivatives of a pose with the unknowns, which stay in the workspace, and with the inputs. */
static void pose_derivatives_at(int pose, const real *x, const real *inputs, real *d_pose_d_inputs, workspace *work) {
  POSE_DERIVATIVES[pose](x, inputs, work->d_pose_d_x, d_pose_d_inputs);
}

#include "solver_sensitivity.c"
#include "solver_track.c"
#include "solver_recover.c"
/* ---- Many load cases ---- */

#ifdef _OPENMP
#include <omp.h>
#endif

int follower_reissner_solve_batch(int count, const real *inputs, real *x, workspace *workspaces,
                        int workspace_count, solver_info *info) {
  int converged = 0;
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic, 16) reduction(+ : converged) num_threads(workspace_count)
#else
  (void)workspace_count;
#endif
  for (int i = 0; i < count; i++) {
#ifdef _OPENMP
    workspace *work = workspaces + omp_get_thread_num();
#else
    workspace *work = workspaces;
#endif
    real *own = x + (size_t)i * N;
    memset(own, 0, N * sizeof *own);
    converged += solver_solve(inputs + (size_t)i * INPUTS, own, work, info + i) == SOLVER_CONVERGED;
  }
  return converged;
}


void follower_reissner_igm(const real *q, const real *base_position, const real *base_quaternion, const real *inputs,
    real *generalised_force, real *base_force, real *base_moment) {
  ARGUMENTS(follower_reissner_k_igm, q, base_position, base_quaternion, inputs);
  RESULTS(generalised_force, base_force, base_moment);
  CALL_WITHOUT_WORKSPACE(follower_reissner_k_igm)
}

void follower_reissner_tip(const real *x, const real *inputs, real *position, real *quaternion) {
  ARGUMENTS(follower_reissner_k_tip, x, inputs);
  RESULTS(position, quaternion);
  CALL_WITHOUT_WORKSPACE(follower_reissner_k_tip)
}

void follower_reissner_tip_jacobian(const real *x, const real *inputs, real *d_pose_d_x, real *d_pose_d_inputs) {
  ARGUMENTS(follower_reissner_k_tip_jacobian, x, inputs);
  RESULTS(d_pose_d_x, d_pose_d_inputs);
  CALL_WITHOUT_WORKSPACE(follower_reissner_k_tip_jacobian)
}

void follower_reissner_shape(const real *x, const real *inputs, real X, real *position, real *quaternion) {
  ARGUMENTS(follower_reissner_k_shape, x, inputs, &X);
  RESULTS(position, quaternion);
  CALL_WITHOUT_WORKSPACE(follower_reissner_k_shape)
}

void follower_reissner_pack(const follower_reissner_inputs *named, follower_reissner_real *inputs) {
  memcpy(inputs + FOLLOWER_REISSNER_INPUT_THRUSTER_FORCE, named->thruster_force, sizeof named->thruster_force);
  memcpy(inputs + FOLLOWER_REISSNER_INPUT_THRUSTER_MOMENT, named->thruster_moment, sizeof named->thruster_moment);
}

void follower_reissner_unpack(const follower_reissner_real *inputs, follower_reissner_inputs *named) {
  memcpy(named->thruster_force, inputs + FOLLOWER_REISSNER_INPUT_THRUSTER_FORCE, sizeof named->thruster_force);
  memcpy(named->thruster_moment, inputs + FOLLOWER_REISSNER_INPUT_THRUSTER_MOMENT, sizeof named->thruster_moment);
}

static const follower_reissner_real LEAST_INPUTS[FOLLOWER_REISSNER_INPUTS] = {-(follower_reissner_real)HUGE_VAL, -(follower_reissner_real)HUGE_VAL, -(follower_reissner_real)HUGE_VAL, -(follower_reissner_real)HUGE_VAL, -(follower_reissner_real)HUGE_VAL, -(follower_reissner_real)HUGE_VAL};
static const follower_reissner_real LARGEST_INPUTS[FOLLOWER_REISSNER_INPUTS] = {(follower_reissner_real)HUGE_VAL, (follower_reissner_real)HUGE_VAL, (follower_reissner_real)HUGE_VAL, (follower_reissner_real)HUGE_VAL, (follower_reissner_real)HUGE_VAL, (follower_reissner_real)HUGE_VAL};

int follower_reissner_in_range(const follower_reissner_real *inputs) {
  for (int i = 0; i < FOLLOWER_REISSNER_INPUTS; i++) {
    if (!(inputs[i] >= LEAST_INPUTS[i] && inputs[i] <= LARGEST_INPUTS[i])) return 0;
  }
  return 1;
}

int follower_reissner_clamp(follower_reissner_real *inputs) {
  int moved = 0;
  for (int i = 0; i < FOLLOWER_REISSNER_INPUTS; i++) {
    if (inputs[i] < LEAST_INPUTS[i]) {
      inputs[i] = LEAST_INPUTS[i];
      moved++;
    } else if (inputs[i] > LARGEST_INPUTS[i]) {
      inputs[i] = LARGEST_INPUTS[i];
      moved++;
    }
  }
  return moved;
}

void follower_reissner_evaluate(const real *x, const real *inputs, follower_reissner_results *named) {
  follower_reissner_tip(x, inputs, named->tip.position, named->tip.quaternion);
}

int follower_reissner_workspace_size(void) { return (int)FOLLOWER_REISSNER_WORKSPACE_SIZE; }

const char *follower_reissner_status_text(follower_reissner_status status) {
  switch (status) {
    case FOLLOWER_REISSNER_CONVERGED:
      return "Equilibrium found: the residual is below its tolerance.";
    case FOLLOWER_REISSNER_MAX_ITERATIONS:
      return "No equilibrium found: the iterations ran out before the residual was small enough.";
    case FOLLOWER_REISSNER_NOT_FINITE:
      return "No equilibrium found: the equations gave a value that is not a finite number.";
    case FOLLOWER_REISSNER_SINGULAR:
      return "No equilibrium found: the Jacobian is singular and no step reduces the residual.";
    case FOLLOWER_REISSNER_LOAD_STALLED:
      return "No equilibrium found: the path from the unloaded scene, or from the solution started at, could not be followed further; there may be a limit point, a buckling load, or an obstacle or a rod in the way.";
    case FOLLOWER_REISSNER_UNRESOLVED:
      return "An equilibrium of the discrete model was found, but it is not resolved by its modes and nodes, or its steps: allow more of them, or a larger tolerance.";
    case FOLLOWER_REISSNER_NOT_IN_EQUILIBRIUM:
      return "The unknowns are not an equilibrium at these inputs: solve first.";
    case FOLLOWER_REISSNER_LOST_TRACK:
      return "One turn could not follow the solution of the last turn to these inputs within its bounds: move the inputs less in a turn, or solve anew.";
    case FOLLOWER_REISSNER_PATH_VANISHED:
      return "No equilibrium of the rod: it bends so far that the path of a tendon has no length left in it, and further bending would turn the matter inside out: lessen the loads, or move the path nearer to the axis.";
    case FOLLOWER_REISSNER_BEYOND_MATERIAL:
      return "No equilibrium of the rod: a strain, or the pressure in a chamber, is beyond where its law holds, or a further strain would set energy free: lessen the loads, or give the law for larger ones.";
    case FOLLOWER_REISSNER_OUT_OF_PLANE:
      return "No equilibrium of the scene: a joint or a support is out of the plane that its rods bend in, or turned out of it: keep it in the plane, or admit the other bending and torsion of the rods.";
  }
  return "No such status.";
}

const char *follower_reissner_status_label(follower_reissner_status status) {
  switch (status) {
    case FOLLOWER_REISSNER_CONVERGED:
      return "converged";
    case FOLLOWER_REISSNER_MAX_ITERATIONS:
      return "max_iterations";
    case FOLLOWER_REISSNER_NOT_FINITE:
      return "not_finite";
    case FOLLOWER_REISSNER_SINGULAR:
      return "singular";
    case FOLLOWER_REISSNER_LOAD_STALLED:
      return "load_stalled";
    case FOLLOWER_REISSNER_UNRESOLVED:
      return "unresolved";
    case FOLLOWER_REISSNER_NOT_IN_EQUILIBRIUM:
      return "not_in_equilibrium";
    case FOLLOWER_REISSNER_LOST_TRACK:
      return "lost_track";
    case FOLLOWER_REISSNER_PATH_VANISHED:
      return "path_vanished";
    case FOLLOWER_REISSNER_BEYOND_MATERIAL:
      return "beyond_material";
    case FOLLOWER_REISSNER_OUT_OF_PLANE:
      return "out_of_plane";
  }
  return "unknown";
}
