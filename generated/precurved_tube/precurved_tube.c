/* precurved_tube: its equations, and with them the solver, as one translation unit. See precurved_tube.h for what each function does. */
#include "precurved_tube_config.h"

#define casadi_real precurved_tube_real
#define casadi_int int
#include "precurved_tube_kernels.h"

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
    precurved_tube_tip_jacobian,
};

static void residual_at(const real *x, const loads *at, real *residual, workspace *work) {
  ARGUMENTS(precurved_tube_k_residual, x, at->inputs, &at->load_factor);
  RESULTS(residual);
  CALL(precurved_tube_k_residual);
}

static void jacobian_at(const real *x, const loads *at, real *jacobian, workspace *work) {
  ARGUMENTS(precurved_tube_k_jacobian, x, at->inputs, &at->load_factor);
  RESULTS(jacobian);
  CALL(precurved_tube_k_jacobian);
}

static void rate_at(const real *x, const loads *at, const real *inputs_rate, real load_factor_rate, real *rate,
                    workspace *work) {
  ARGUMENTS(precurved_tube_k_rate, x, at->inputs, &at->load_factor, inputs_rate, &load_factor_rate);
  RESULTS(rate);
  CALL(precurved_tube_k_rate);
}

/* dx/d load_factor of the unloaded scene. */
static void unloaded_tangent(const real *inputs, real *tangent, workspace *work) {
  ARGUMENTS(precurved_tube_k_tangent, inputs);
  RESULTS(tangent);
  CALL(precurved_tube_k_tangent);
}

static real resolution_index(const real *x, const real *inputs, workspace *work) {
  real index;
  ARGUMENTS(precurved_tube_k_resolution_index, x, inputs);
  RESULTS(&index);
  CALL(precurved_tube_k_resolution_index);
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
  STRAINS = 3,
  WATCHED_POSES = 1,
  WATCHED_CABLES = 0,
  WATCHED = POSE_SIZE * WATCHED_POSES + WATCHED_CABLES
};

#include "blind_turns.c"

/* Pairs of degrees: 2 k of strain k for the two highest, 2 k + 1 for the two below; else 2 STRAINS + 1. */
static const int PAIR_OF_UNKNOWN[N] = {7, 7, 7, 1, 7, 7, 7, 3, 7, 7, 7, 7, 5};
static const int PAIR_OF_MISSING[MISSING] = {1, 0, 0, 3, 2, 2, 5, 4, 4};

static const int TURNED_OF_UNKNOWN[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0};
static const real TURNED_BY_UNKNOWN[] = {
  (real)0.86710996952412, (real)0.5006261743217587, (real)0.38778336716474043, (real)0.3277367626722309,
  (real)0.86710996952412, (real)0.5006261743217587, (real)0.38778336716474043, (real)0.3277367626722309, (real)1.0,
  (real)0.5773502691896257, (real)0.4472135954999578, (real)0.3779644730092271, (real)0.33333333333333315};
static const real TURNED_UNLOADED[] = {(real)2.768307559469702};
static const int TURNED_OF_MISSING[] = {0, 0, 0, 0, 0, 0, 0, 0, 0};
static const int TURNED_MODES[] = {7, 7, 7, 7, 7, 7, 8, 8, 8};
static const turned_elements TURNED = {.elements = 1, .unknowns = 13, .missing = 9, .of_unknown = TURNED_OF_UNKNOWN, .by_unknown = TURNED_BY_UNKNOWN, .unloaded = TURNED_UNLOADED, .of_missing = TURNED_OF_MISSING, .modes = TURNED_MODES};

/* Elastic steps of unknowns and missing coordinates at a corrected answer, the residual in the unknowns, and what is
   watched, one behind the other. */
static void richer_balance_at(const real *x, const real *correction, const real *missing, const real *inputs, real *balance,
                              workspace *work) {
  ARGUMENTS(precurved_tube_k_richer_balance, x, correction, missing, inputs);
  RESULTS(balance);
  CALL(precurved_tube_k_richer_balance);
}

/* What is watched: positions over lengths, then quaternions, then lengths of cables over those of their rods. */
static void watched_at(const real *x, const real *inputs, real *watched, workspace *work) {
  ARGUMENTS(precurved_tube_k_watched, x, inputs);
  RESULTS(watched);
  CALL(precurved_tube_k_watched);
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

int precurved_tube_solve_batch(int count, const real *inputs, real *x, workspace *workspaces,
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


void precurved_tube_igm(const real *q, const real *base_position, const real *base_quaternion, const real *inputs,
    real *generalised_force, real *base_force, real *base_moment) {
  ARGUMENTS(precurved_tube_k_igm, q, base_position, base_quaternion, inputs);
  RESULTS(generalised_force, base_force, base_moment);
  CALL_WITHOUT_WORKSPACE(precurved_tube_k_igm)
}

void precurved_tube_tip(const real *x, const real *inputs, real *position, real *quaternion) {
  ARGUMENTS(precurved_tube_k_tip, x, inputs);
  RESULTS(position, quaternion);
  CALL_WITHOUT_WORKSPACE(precurved_tube_k_tip)
}

void precurved_tube_tip_jacobian(const real *x, const real *inputs, real *d_pose_d_x, real *d_pose_d_inputs) {
  ARGUMENTS(precurved_tube_k_tip_jacobian, x, inputs);
  RESULTS(d_pose_d_x, d_pose_d_inputs);
  CALL_WITHOUT_WORKSPACE(precurved_tube_k_tip_jacobian)
}

void precurved_tube_shape(const real *x, const real *inputs, real X, real *position, real *quaternion) {
  ARGUMENTS(precurved_tube_k_shape, x, inputs, &X);
  RESULTS(position, quaternion);
  CALL_WITHOUT_WORKSPACE(precurved_tube_k_shape)
}

void precurved_tube_pack(const precurved_tube_inputs *named, precurved_tube_real *inputs) {
  memcpy(inputs + PRECURVED_TUBE_INPUT_TISSUE_FORCE, named->tissue_force, sizeof named->tissue_force);
  memcpy(inputs + PRECURVED_TUBE_INPUT_TISSUE_MOMENT, named->tissue_moment, sizeof named->tissue_moment);
}

void precurved_tube_unpack(const precurved_tube_real *inputs, precurved_tube_inputs *named) {
  memcpy(named->tissue_force, inputs + PRECURVED_TUBE_INPUT_TISSUE_FORCE, sizeof named->tissue_force);
  memcpy(named->tissue_moment, inputs + PRECURVED_TUBE_INPUT_TISSUE_MOMENT, sizeof named->tissue_moment);
}

static const precurved_tube_real LEAST_INPUTS[PRECURVED_TUBE_INPUTS] = {-(precurved_tube_real)HUGE_VAL, -(precurved_tube_real)HUGE_VAL, -(precurved_tube_real)HUGE_VAL, -(precurved_tube_real)HUGE_VAL, -(precurved_tube_real)HUGE_VAL, -(precurved_tube_real)HUGE_VAL};
static const precurved_tube_real LARGEST_INPUTS[PRECURVED_TUBE_INPUTS] = {(precurved_tube_real)HUGE_VAL, (precurved_tube_real)HUGE_VAL, (precurved_tube_real)HUGE_VAL, (precurved_tube_real)HUGE_VAL, (precurved_tube_real)HUGE_VAL, (precurved_tube_real)HUGE_VAL};

int precurved_tube_in_range(const precurved_tube_real *inputs) {
  for (int i = 0; i < PRECURVED_TUBE_INPUTS; i++) {
    if (!(inputs[i] >= LEAST_INPUTS[i] && inputs[i] <= LARGEST_INPUTS[i])) return 0;
  }
  return 1;
}

int precurved_tube_clamp(precurved_tube_real *inputs) {
  int moved = 0;
  for (int i = 0; i < PRECURVED_TUBE_INPUTS; i++) {
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

void precurved_tube_evaluate(const real *x, const real *inputs, precurved_tube_results *named) {
  precurved_tube_tip(x, inputs, named->tip.position, named->tip.quaternion);
}

int precurved_tube_workspace_size(void) { return (int)PRECURVED_TUBE_WORKSPACE_SIZE; }

const char *precurved_tube_status_text(precurved_tube_status status) {
  switch (status) {
    case PRECURVED_TUBE_CONVERGED:
      return "Equilibrium found: the residual is below its tolerance.";
    case PRECURVED_TUBE_MAX_ITERATIONS:
      return "No equilibrium found: the iterations ran out before the residual was small enough.";
    case PRECURVED_TUBE_NOT_FINITE:
      return "No equilibrium found: the equations gave a value that is not a finite number.";
    case PRECURVED_TUBE_SINGULAR:
      return "No equilibrium found: the Jacobian is singular and no step reduces the residual.";
    case PRECURVED_TUBE_LOAD_STALLED:
      return "No equilibrium found: the path from the unloaded scene, or from the solution started at, could not be followed further; there may be a limit point, a buckling load, or an obstacle or a rod in the way.";
    case PRECURVED_TUBE_UNRESOLVED:
      return "An equilibrium of the discrete model was found, but it is not resolved by its modes and nodes, or its steps: allow more of them, or a larger tolerance.";
    case PRECURVED_TUBE_NOT_IN_EQUILIBRIUM:
      return "The unknowns are not an equilibrium at these inputs: solve first.";
    case PRECURVED_TUBE_LOST_TRACK:
      return "One turn could not follow the solution of the last turn to these inputs within its bounds: move the inputs less in a turn, or solve anew.";
    case PRECURVED_TUBE_PATH_VANISHED:
      return "No equilibrium of the rod: it bends so far that the path of a tendon has no length left in it, and further bending would turn the matter inside out: lessen the loads, or move the path nearer to the axis.";
    case PRECURVED_TUBE_BEYOND_MATERIAL:
      return "No equilibrium of the rod: a strain, or the pressure in a chamber, is beyond where its law holds, or a further strain would set energy free: lessen the loads, or give the law for larger ones.";
    case PRECURVED_TUBE_OUT_OF_PLANE:
      return "No equilibrium of the scene: a joint or a support is out of the plane that its rods bend in, or turned out of it: keep it in the plane, or admit the other bending and torsion of the rods.";
  }
  return "No such status.";
}

const char *precurved_tube_status_label(precurved_tube_status status) {
  switch (status) {
    case PRECURVED_TUBE_CONVERGED:
      return "converged";
    case PRECURVED_TUBE_MAX_ITERATIONS:
      return "max_iterations";
    case PRECURVED_TUBE_NOT_FINITE:
      return "not_finite";
    case PRECURVED_TUBE_SINGULAR:
      return "singular";
    case PRECURVED_TUBE_LOAD_STALLED:
      return "load_stalled";
    case PRECURVED_TUBE_UNRESOLVED:
      return "unresolved";
    case PRECURVED_TUBE_NOT_IN_EQUILIBRIUM:
      return "not_in_equilibrium";
    case PRECURVED_TUBE_LOST_TRACK:
      return "lost_track";
    case PRECURVED_TUBE_PATH_VANISHED:
      return "path_vanished";
    case PRECURVED_TUBE_BEYOND_MATERIAL:
      return "beyond_material";
    case PRECURVED_TUBE_OUT_OF_PLANE:
      return "out_of_plane";
  }
  return "unknown";
}
