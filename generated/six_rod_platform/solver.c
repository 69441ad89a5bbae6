/* Solver of the equilibrium equations: damped Newton with a Broyden-updated Jacobian, inside natural continuation in the
   load or in the inputs. See the library's header for what each public function promises.

   cosserat_casadi/numerics holds the same algorithm in Python: newton.py, broyden.py, continuation.py. */

/* ---- Newton ---- */

typedef struct {
  solver_status status;
  int iterations;
  int jacobians;
  int damped;
  real residual_norm; /* relative: over one plus the norm of the unknowns */
} newton_result;

/* When Newton gives up; the length of the step to come below which it stops before the tolerance, 0 for never; whether
   it begins with the Jacobian at hand. */
typedef struct {
  int max_iterations;
  int max_jacobians;
  int max_halvings;
  real inexact;
  int reuse_jacobian;
} newton_limits;

static const newton_limits DAMPED_NEWTON = {
    .max_iterations = MAX_ITERATIONS,
    .max_jacobians = MAX_ITERATIONS,
    .max_halvings = MAX_HALVINGS,
    .inexact = 0,
    .reuse_jacobian = 0,
};

/* What is left of a product with the inverse of the Jacobian: one rank-one update for each step and its follower. */
static void apply_updates(const updated_jacobian *jacobian, real *result) {
  for (int j = 0; j + 1 < jacobian->count; j++) {
    const real share = dot(jacobian->steps[j], result) / jacobian->squares[j];
    for (int i = 0; i < N; i++) result[i] += jacobian->steps[j + 1][i] * share;
  }
}

/* Minus the inverse of the Jacobian times a vector. */
static void apply_inverse(const updated_jacobian *jacobian, const real *vector, real *result, workspace *work) {
  for (int i = 0; i < N; i++) result[i] = -vector[i];
  back_substitute(&jacobian->factors, result, work);
  apply_updates(jacobian, result);
}

/* The quasi-Newton step at an iterate from minus the inverse times the residual there; zero where it is not finite. The
   update is C. G. Broyden's (Math. Comp. 19, 1965, 577-593); its inverse is applied from the steps alone: C. T. Kelley,
   Iterative Methods for Linear and Nonlinear Equations, SIAM 1995, section 7.3. */
static int complete_step(const updated_jacobian *jacobian, real *step) {
  if (jacobian->count > 0) {
    const int last = jacobian->count - 1;
    const real share = 1 - dot(jacobian->steps[last], step) / jacobian->squares[last];
    for (int i = 0; i < N; i++) step[i] /= share;
  }
  return all_finite(step, N);
}

static int newton_step(const updated_jacobian *jacobian, const real *residual, real *step, workspace *work) {
  apply_inverse(jacobian, residual, step, work);
  return complete_step(jacobian, step);
}

/* Minus the inverse times any vector, at an iterate with this residual: the update that belongs to the last step needs
   the step that would follow it. Zero where the result is not finite. */
static int response(const updated_jacobian *jacobian, const real *residual, const real *vector, real *result,
                    workspace *work) {
  apply_inverse(jacobian, vector, result, work);
  if (jacobian->count > 0 && newton_step(jacobian, residual, work->next_step, work)) {
    const int last = jacobian->count - 1;
    const real share = dot(jacobian->steps[last], result) / jacobian->squares[last];
    for (int i = 0; i < N; i++) result[i] += work->next_step[i] * share;
  }
  return all_finite(result, N);
}

/* Whether a step of this length brings the residual down far enough. */
static int serves(real length, real trial_norm, real norm) {
  return isfinite(trial_norm) && trial_norm <= (1 - SUFFICIENT_DECREASE * length) * norm;
}

/* Halves the step until the residual falls. Returns the length that served, or zero; moves x, residual and norm on. */
static real line_search(const loads *at, const real *step, int max_halvings, real *x, real *residual, real *norm,
                        workspace *work) {
  real *trial = work->trial;
  real *trial_residual = work->trial_residual;
  real length = 1;
  for (int k = 0; k <= max_halvings; k++) {
    for (int i = 0; i < N; i++) trial[i] = x[i] + length * step[i];
    residual_at(trial, at, trial_residual, work);
    const real trial_norm = norm_of(trial_residual);
    if (serves(length, trial_norm, *norm)) {
      memcpy(x, trial, N * sizeof *x);
      memcpy(residual, trial_residual, N * sizeof *residual);
      *norm = trial_norm;
      return length;
    }
    length /= 2;
  }
  return 0;
}

/* Remembers a full step for the updates. Returns its length. */
static real append_step(updated_jacobian *jacobian, const real *step) {
  const real square = dot(step, step);
  memcpy(jacobian->steps[jacobian->count], step, N * sizeof *step);
  jacobian->squares[jacobian->count] = square;
  jacobian->count++;
  return SQUARE_ROOT(square);
}

/* Where Newton stands at an iterate. */
typedef struct {
  newton_result result;
  int reuse_jacobian;
  real norm; /* of the residual */
} newton_state;

static newton_state begin_newton(const newton_limits *limits, const real *residual) {
  const newton_state state = {
      .result = {.status = SOLVER_MAX_ITERATIONS, .iterations = 0, .jacobians = 0, .damped = 0, .residual_norm = 0},
      .reuse_jacobian = limits->reuse_jacobian,
      .norm = norm_of(residual),
  };
  return state;
}

/* Whether Newton ends at x, by what its result says. */
static int newton_ends(newton_state *state, const newton_limits *limits, const real *x) {
  newton_result *result = &state->result;
  const real size = 1 + norm_of(x);
  result->residual_norm = state->norm / size;
  /* Beside unknowns whose norm overflows any residual would be small. */
  if (!isfinite(state->norm) || !isfinite(size)) {
    result->status = SOLVER_NOT_FINITE;
    return 1;
  }
  if (state->norm <= TOLERANCE * size) result->status = SOLVER_CONVERGED;
  if (result->status == SOLVER_CONVERGED || result->iterations >= limits->max_iterations) return 1;
  return !state->reuse_jacobian && result->jacobians == limits->max_jacobians;
}

/* Counts a new Jacobian, which no update has changed yet. */
static void expect_jacobian(newton_state *state, updated_jacobian *jacobian) {
  state->result.jacobians++;
  jacobian->count = 0;
}

/* What follows from a step of this length that has left the residual with this norm; of length zero where none served.
   Returns zero where Newton ends. */
static int weigh_step(newton_state *state, const newton_limits *limits, const real *step, real length, real norm,
                      updated_jacobian *jacobian) {
  const real previous_norm = state->norm;
  state->norm = norm;
  if (length == 0) {
    if (!state->reuse_jacobian) {
      state->result.status = SOLVER_SINGULAR;
      return 0;
    }
    state->reuse_jacobian = 0;
    return 1;
  }
  if (length < 1) {
    state->result.damped = 1;
    state->reuse_jacobian = 0;
    return 1;
  }
  /* The step to come is about as much shorter than this one as the residual has fallen. */
  if (append_step(jacobian, step) * norm < limits->inexact * previous_norm) state->result.status = SOLVER_CONVERGED;
  state->reuse_jacobian = norm <= REUSE_DECREASE * previous_norm && jacobian->count < MAX_REUSES;
  return 1;
}

/* Newton from x, with the residual there. Moves both on, and leaves the last Jacobian. */
static newton_result newton(const loads *at, const newton_limits *limits, real *x, real *residual,
                            updated_jacobian *jacobian, workspace *work) {
  newton_state state = begin_newton(limits, residual);
  while (!newton_ends(&state, limits, x)) {
    if (!state.reuse_jacobian) {
      expect_jacobian(&state, jacobian);
      if (!linearise(x, at, &jacobian->factors, work)) {
        state.result.status = SOLVER_NOT_FINITE;
        break;
      }
    }
    state.result.iterations++;
    real norm = state.norm;
    real length = 0;
    if (newton_step(jacobian, residual, work->step, work)) {
      /* A step of an old Jacobian is not halved: a new Jacobian is worth more. */
      const int max_halvings = state.reuse_jacobian ? 0 : limits->max_halvings;
      length = line_search(at, work->step, max_halvings, x, residual, &norm, work);
    }
    if (!weigh_step(&state, limits, work->step, length, norm, jacobian)) break;
  }
  return state.result;
}

static void count_work(solver_info *info, const newton_result *result) {
  info->iterations += result->iterations;
  info->jacobians += result->jacobians;
}

/* ---- Continuation ---- */

/* From the unloaded scene under growing loads, or from some inputs to others; t from 0 to 1. */
typedef struct {
  int grows_load;
  const real *from;
  const real *to;
} load_path;

typedef struct {
  int max_steps;
  int max_iterations;
} path_limits;

static const path_limits LONG_PATH = {.max_steps = MAX_STEPS, .max_iterations = MAX_STEPS * (MAX_ITERATIONS + 1)};

/* Where a continuation stands: the last two points and room for the next, the Jacobian of the last and room for one. */
typedef struct {
  path_point *point;
  path_point *previous; /* null at the first point */
  path_point *next;
  path_point *spare_point;
  updated_jacobian *jacobian;
  updated_jacobian *spare;
  int has_jacobian;
} progress;

/* The loads at t; the inputs lie in the workspace until the next call. */
static loads loads_at(const load_path *path, real t, workspace *work) {
  loads at = {work->path_inputs, 1};
  if (path->grows_load) {
    at.inputs = path->to;
    at.load_factor = t;
    return at;
  }
  /* Exact at both ends, however different in size the two are. */
  for (int i = 0; i < INPUTS; i++) work->path_inputs[i] = (1 - t) * path->from[i] + t * path->to[i];
  return at;
}

/* Length of a change of the unknowns: strains and poses count whole, forces by a share. */
static real step_length(const real *step) {
  real sum = 0;
  for (int i = 0; i < N; i++) {
    const real weighted = step[i] * STEP_WEIGHTS[i];
    sum += weighted * weighted;
  }
  return SQUARE_ROOT(sum);
}

/* Whether a correction leaves a point on the path and not on another. */
static int is_small(const real *correction, const real *predicted) {
  return step_length(correction) <= (real)0.3 + (real)0.5 * step_length(predicted);
}

/* The response to the rate of the residual; zero where that, or the Jacobian, is not sound. */
static void set_tangent(path_point *point, int sound, const updated_jacobian *jacobian, workspace *work) {
  if (!sound || !response(jacobian, point->residual, work->rate, point->tangent, work)) {
    memset(point->tangent, 0, sizeof point->tangent);
  }
}

/* dx/dt at a point of the path, with the Jacobian that Newton has left there; zero where there is none. Returns the
   number of Jacobians that it took. */
static int tangent_at(const load_path *path, path_point *point, int has_jacobian, updated_jacobian *jacobian,
                      workspace *work) {
  const loads at = loads_at(path, point->t, work);
  const real load_factor_rate = path->grows_load ? 1 : 0;
  int jacobians = 0;
  for (int i = 0; i < INPUTS; i++) work->inputs_rate[i] = path->grows_load ? 0 : path->to[i] - path->from[i];
  rate_at(point->x, &at, work->inputs_rate, load_factor_rate, work->rate, work);
  int sound = all_finite(work->rate, N);
  if (sound && !has_jacobian) {
    jacobian->count = 0;
    jacobians = 1;
    sound = linearise(point->x, &at, &jacobian->factors, work);
  }
  set_tangent(point, sound, jacobian, work);
  return jacobians;
}

/* Predictor: the change of x by the cubic through two points and their tangents; by the tangent where there is one point,
   or the two differ much. */
static void predict(const path_point *point, const path_point *previous, real step, real *predicted, real *bent) {
  for (int i = 0; i < N; i++) predicted[i] = step * point->tangent[i];
  if (!previous) return;
  const real interval = point->t - previous->t;
  const real share = step / interval;
  for (int i = 0; i < N; i++) {
    const real change = point->x[i] - previous->x[i];
    const real cubic = interval * (point->tangent[i] + previous->tangent[i]) - 2 * change;
    bent[i] = share * share * (cubic + interval * point->tangent[i] - change) + share * share * share * cubic;
  }
  if (step_length(bent) > MAX_CURVATURE_SHARE * step_length(predicted)) return;
  for (int i = 0; i < N; i++) predicted[i] += bent[i];
}

/* Length of the next step, which is wanted this long; zero where that would be too short to go on with. */
static real admissible_step(const progress *now, real wanted) {
  const real rest = 1 - now->point->t;
  const real length = step_length(now->point->tangent);
  real step = wanted > rest ? rest : wanted;
  if (step * length > MAX_STEP_LENGTH) step = MAX_STEP_LENGTH / length;
  return step < MIN_STEP && step < rest ? 0 : step;
}

/* Writes the predicted next point. */
static void predict_next(const progress *now, real step, workspace *work) {
  path_point *next = now->next;
  const real end = now->point->t + step;
  next->t = end > 1 - (real)1e-12 ? 1 : end;
  predict(now->point, now->previous, step, work->predicted, work->correction);
  for (int i = 0; i < N; i++) next->x[i] = now->point->x[i] + work->predicted[i];
}

/* Zero where the Jacobian at hand foresees a correction of the predicted point, with the residual there, too large to be
   trusted: a new Jacobian costs far more than to ask it. */
static int is_promising(const progress *now, workspace *work) {
  if (!now->has_jacobian) return 1;
  if (!response(now->jacobian, now->point->residual, now->next->residual, work->correction, work)) return 1;
  return is_small(work->correction, work->predicted);
}

/* Corrector: Newton at the next point, inexact on the way and exact at the end. Damping is not allowed: far from the path
   Newton finds some equilibrium, not the one that the path leads to. */
static newton_limits corrector_limits(const path_point *next, int max_iterations) {
  const newton_limits limits = {
      .max_iterations = max_iterations < MAX_ITERATIONS ? max_iterations : MAX_ITERATIONS,
      .max_jacobians = REJECT_ABOVE,
      .max_halvings = 0,
      .inexact = next->t == 1 ? 0 : INEXACT,
      .reuse_jacobian = 0,
  };
  return limits;
}

static int is_trusted(const newton_result *result, const progress *now, workspace *work) {
  if (result->status != SOLVER_CONVERGED || result->damped) return 0;
  for (int i = 0; i < N; i++) work->correction[i] = now->next->x[i] - now->point->x[i] - work->predicted[i];
  return is_small(work->correction, work->predicted);
}

/* The next point becomes the point. */
static void accept_next(progress *now) {
  path_point *free_point = now->previous ? now->previous : now->spare_point;
  updated_jacobian *free_jacobian = now->jacobian;
  now->previous = now->point;
  now->point = now->next;
  now->next = free_point;
  now->jacobian = now->spare;
  now->spare = free_jacobian;
  now->has_jacobian = 1;
}

static progress begin_path(int has_jacobian, workspace *work) {
  const progress now = {
      .point = work->points,
      .previous = 0,
      .next = work->points + 1,
      .spare_point = work->points + 2,
      .jacobian = work->updated_jacobians,
      .spare = work->updated_jacobians + 1,
      .has_jacobian = has_jacobian,
  };
  return now;
}

/* From the equilibrium at t = 0 in points[0], with its tangent and, where it is known, its Jacobian in
   updated_jacobians[0], towards t = 1. Returns the last point, which was found inexactly unless it is the end. */
static progress follow_path(const load_path *path, const path_limits *limits, int has_jacobian, workspace *work,
                            solver_info *info) {
  progress now = begin_path(has_jacobian, work);
  real step = path->grows_load ? FIRST_STEP : 1;
  for (int k = 0; k < limits->max_steps && info->iterations < limits->max_iterations; k++) {
    step = admissible_step(&now, step);
    if (step == 0) break;
    predict_next(&now, step, work);
    const loads at = loads_at(path, now.next->t, work);
    residual_at(now.next->x, &at, now.next->residual, work);
    if (!is_promising(&now, work)) {
      info->iterations++;
      step /= 2;
      continue;
    }
    const newton_limits corrector = corrector_limits(now.next, limits->max_iterations - info->iterations);
    const newton_result result = newton(&at, &corrector, now.next->x, now.next->residual, now.spare, work);
    count_work(info, &result);
    if (!is_trusted(&result, &now, work)) {
      step /= 2;
      continue;
    }
    if (now.next->t < 1) {
      if (result.jacobians <= GROW_BELOW) step *= 2;
      info->jacobians += tangent_at(path, now.next, result.jacobians > 0, now.spare, work);
    }
    accept_next(&now);
    if (now.point->t == 1) {
      info->status = SOLVER_CONVERGED;
      info->residual_norm = result.residual_norm;
      break;
    }
  }
  info->load_factor = now.point->t;
  return now;
}

/* Follows a path as far as it goes; x is the last point, as near to equilibrium as Newton brings it. */
static void follow_to_the_end(const load_path *path, int has_jacobian, real *x, workspace *work, solver_info *info) {
  const progress end = follow_path(path, &LONG_PATH, has_jacobian, work, info);
  memcpy(x, end.point->x, N * sizeof *x);
  if (end.point->t == 1) return;
  const loads at = loads_at(path, end.point->t, work);
  const newton_result result = newton(&at, &DAMPED_NEWTON, x, end.point->residual, end.spare, work);
  count_work(info, &result);
  info->status = SOLVER_LOAD_STALLED;
  info->residual_norm = result.residual_norm;
}

static void solve_from_unloaded(const real *inputs, real *x, workspace *work, solver_info *info) {
  const load_path path = {.grows_load = 1, .from = inputs, .to = inputs};
  path_point *first = work->points;
  memset(x, 0, N * sizeof *x);
  memset(first, 0, sizeof *first);
  unloaded_tangent(inputs, first->tangent, work);
  if (!isfinite(norm_of(first->tangent))) {
    info->status = SOLVER_NOT_FINITE;
    return;
  }
  follow_to_the_end(&path, 0, x, work, info);
}

/* Begins a path at the equilibrium near x for the inputs `from`: in points[0], with tangent and Jacobian. */
static newton_result start_path(const load_path *path, const newton_limits *limits, const real *x, workspace *work) {
  path_point *first = work->points;
  updated_jacobian *jacobian = work->updated_jacobians;
  memcpy(first->x, x, N * sizeof *x);
  first->t = 0;
  const loads at = loads_at(path, 0, work);
  residual_at(first->x, &at, first->residual, work);
  newton_result result = newton(&at, limits, first->x, first->residual, jacobian, work);
  if (result.status == SOLVER_CONVERGED) {
    result.jacobians += tangent_at(path, first, result.jacobians > 0, jacobian, work);
  }
  return result;
}

/* ---- Public functions ---- */

/* How far two shapes are apart: by strains and poses of frames. Multipliers and tensions may jump where a stiff rod is
   moved by a hair, and tell nothing of the branch. */
static real shape_distance(const real *a, const real *b) {
  real sum = 0;
  for (int i = 0; i < N; i++) {
    if (IS_SHAPE[i]) sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return SQUARE_ROOT(sum);
}

/* Newton at the full load from x; zero, and x as it was, where that strays so far that it may be another branch. Leaves
   the last Jacobian in updated_jacobians[0]. */
static int correct(const newton_limits *limits, const real *inputs, real *x, workspace *work, solver_info *info) {
  real *trial = work->points[0].x;
  real *residual = work->points[0].residual;
  const loads at = full_load(inputs);
  memcpy(trial, x, N * sizeof *x);
  residual_at(trial, &at, residual, work);
  const newton_result result = newton(&at, limits, trial, residual, work->updated_jacobians, work);
  count_work(info, &result);
  if (result.status != SOLVER_CONVERGED || result.damped) return 0;
  if (shape_distance(trial, x) > SAME_BRANCH) return 0;
  memcpy(x, trial, N * sizeof *x);
  info->status = result.status;
  info->residual_norm = result.residual_norm;
  info->load_factor = 1;
  return 1;
}

static int is_zero(const real *x) {
  for (int i = 0; i < N; i++) {
    if (x[i] != 0) return 0;
  }
  return 1;
}

static solver_info no_result(void) {
  const solver_info none = {
      .status = SOLVER_NOT_FINITE, .iterations = 0, .jacobians = 0, .residual_norm = 0, .load_factor = 0};
  return none;
}

/* Nodes too few for so bent a rod give equations whose solution is not one of the rod. */
static solver_status finish(const real *x, const real *inputs, solver_info *found, solver_info *info, workspace *work) {
  if (found->status == SOLVER_CONVERGED && !(resolution_index(x, inputs, work) <= 1)) found->status = SOLVER_UNRESOLVED;
  if (info) *info = *found;
  return found->status;
}

solver_status solver_solve(const real *inputs, real *x, solver_workspace *work, solver_info *info) {
  solver_info found = no_result();
  if (all_finite(inputs, INPUTS)) {
    const int warm = all_finite(x, N) && !is_zero(x);
    if (!warm || !correct(&DAMPED_NEWTON, inputs, x, work, &found)) solve_from_unloaded(inputs, x, work, &found);
  }
  return finish(x, inputs, &found, info, work);
}

solver_status solver_follow(const real *from, const real *inputs, real *x, solver_workspace *work, solver_info *info) {
  solver_info found = no_result();
  const load_path path = {.grows_load = 0, .from = from, .to = inputs};
  if (all_finite(from, INPUTS) && all_finite(inputs, INPUTS) && all_finite(x, N)) {
    const newton_result start = start_path(&path, &DAMPED_NEWTON, x, work);
    count_work(&found, &start);
    found.status = start.status;
    found.residual_norm = start.residual_norm;
    if (start.status == SOLVER_CONVERGED) follow_to_the_end(&path, 1, x, work, &found);
  }
  return finish(x, inputs, &found, info, work);
}

/* Cases first to last, one after the other. */
static int solve_run(int first, int last, const real *inputs, real *x, workspace *work, solver_info *info) {
  int converged = 0;
  for (int i = first; i < last; i++) {
    real *own = x + (size_t)i * N;
    const int continues = i > first && info[i - 1].status == SOLVER_CONVERGED;
    if (continues) {
      memcpy(own, own - N, N * sizeof *own);
    } else {
      memset(own, 0, N * sizeof *own);
    }
    converged += solver_solve(inputs + (size_t)i * INPUTS, own, work, info + i) == SOLVER_CONVERGED;
  }
  return converged;
}

#ifdef _OPENMP
#include <omp.h>

int solver_solve_batch(int count, const real *inputs, real *x, solver_workspace *workspaces, int workspace_count,
                       solver_info *info) {
  enum { RUN = 64 };
  int converged = 0;
#pragma omp parallel for schedule(dynamic) reduction(+ : converged) num_threads(workspace_count)
  for (int first = 0; first < count; first += RUN) {
    const int last = count - first < RUN ? count : first + RUN;
    converged += solve_run(first, last, inputs, x, workspaces + omp_get_thread_num(), info);
  }
  return converged;
}
#else
int solver_solve_batch(int count, const real *inputs, real *x, solver_workspace *workspaces, int workspace_count,
                       solver_info *info) {
  (void)workspace_count;
  return solve_run(0, count, inputs, x, workspaces, info);
}
#endif

void solver_residual(const real *x, const real *inputs, real *residual, solver_workspace *work) {
  const loads at = full_load(inputs);
  residual_at(x, &at, residual, work);
}

void solver_residual_jacobian(const real *x, const real *inputs, real *jacobian, real *residual,
                              solver_workspace *work) {
  const loads at = full_load(inputs);
  residual_at(x, &at, residual, work);
  dense_jacobian_at(x, &at, jacobian, work);
}

void solver_input_jacobian(const real *x, const real *inputs, real *d_residual_d_inputs, solver_workspace *work) {
  const loads at = full_load(inputs);
  input_jacobian_at(x, &at, d_residual_d_inputs, work);
}

/* Adds d_pose_d_x times d_x_d_inputs to d_pose_d_inputs. A pose depends on few rods: columns of zeros are left out. */
static void add_product(const real *d_pose_d_x, const real *d_x_d_inputs, real *d_pose_d_inputs) {
  for (int k = 0; k < N; k++) {
    const real *column = d_pose_d_x + k * POSE_SIZE;
    int any = 0;
    for (int i = 0; i < POSE_SIZE; i++) any |= column[i] != 0;
    if (!any) continue;
    for (int j = 0; j < INPUTS; j++) {
      const real factor = d_x_d_inputs[j * N + k];
      real *target = d_pose_d_inputs + j * POSE_SIZE;
      for (int i = 0; i < POSE_SIZE; i++) target[i] += column[i] * factor;
    }
  }
}

/* Derivatives of the solution by the implicit function theorem; leaves the factorised Jacobian in
   updated_jacobians[0]. Writes nothing unless it returns CONVERGED. */
static solver_status derivatives(const real *inputs, const real *x, real *d_x_d_inputs, real *d_poses_d_inputs,
                                 workspace *work) {
  updated_jacobian *jacobian = work->updated_jacobians;
  const loads at = full_load(inputs);
  jacobian->count = 0;
  if (!linearise(x, &at, &jacobian->factors, work)) return SOLVER_NOT_FINITE;
  if (!jacobian->factors.regular) return SOLVER_SINGULAR;
  real *columns = work->d_x_d_inputs;
  input_jacobian_at(x, &at, columns, work);
  for (int j = 0; j < INPUTS; j++) {
    real *column = columns + j * N;
    for (int i = 0; i < N; i++) column[i] = -column[i];
    back_substitute(&jacobian->factors, column, work);
  }
  if (!all_finite(columns, N * INPUTS)) return SOLVER_SINGULAR;
  if (d_x_d_inputs) memcpy(d_x_d_inputs, columns, (size_t)N * INPUTS * sizeof *columns);
  if (!d_poses_d_inputs) return SOLVER_CONVERGED;
  for (int i = 0; i < POSES; i++) {
    real *pose = d_poses_d_inputs + i * POSE_SIZE * INPUTS;
    POSE_DERIVATIVES[i](x, inputs, work->d_pose_d_x, pose);
    add_product(work->d_pose_d_x, columns, pose);
  }
  return SOLVER_CONVERGED;
}

solver_status solver_solve_sensitivity(const real *inputs, const real *x, real *d_x_d_inputs, real *d_poses_d_inputs,
                                       solver_workspace *work) {
  const real size = 1 + norm_of(x);
  if (!all_finite(inputs, INPUTS) || !isfinite(size)) return SOLVER_NOT_FINITE;
  const loads at = full_load(inputs);
  residual_at(x, &at, work->trial_residual, work);
  if (!(norm_of(work->trial_residual) <= 10 * TOLERANCE * size)) return SOLVER_NOT_IN_EQUILIBRIUM;
  return derivatives(inputs, x, d_x_d_inputs, d_poses_d_inputs, work);
}

/* ---- A control loop ---- */

static const solver_options DEFAULT_OPTIONS = {
    .max_iterations = SOLVER_DEFAULT_ITERATIONS,
    .max_continuation_steps = SOLVER_DEFAULT_CONTINUATION_STEPS,
};

/* From the solution for the inputs of the last turn along the straight line to the new ones; zero, and x as it was, where
   the budget of the turn is spent before the end. */
static int follow_last_turn(const solver_memory *memory, const solver_options *options, const real *inputs, real *x,
                            workspace *work, solver_info *info) {
  const load_path path = {.grows_load = 0, .from = memory->inputs, .to = inputs};
  const path_limits limits = {
      .max_steps = options->max_continuation_steps,
      .max_iterations = options->max_iterations,
  };
  const newton_limits start_limits = {
      .max_iterations = options->max_iterations - info->iterations,
      .max_jacobians = options->max_iterations,
      .max_halvings = 0,
      .inexact = 0,
      .reuse_jacobian = 0,
  };
  if (!memory->has_inputs || options->max_continuation_steps < 1) return 0;
  const newton_result start = start_path(&path, &start_limits, x, work);
  count_work(info, &start);
  if (start.status != SOLVER_CONVERGED) return 0;
  const progress end = follow_path(&path, &limits, 1, work, info);
  if (end.point->t < 1) return 0;
  memcpy(x, end.point->x, N * sizeof *x);
  return 1;
}

solver_status solver_track(const real *inputs, real *x, solver_memory *memory, const solver_options *options,
                           real *d_x_d_inputs, real *d_poses_d_inputs, solver_workspace *work, solver_info *info) {
  const solver_options chosen = options ? *options : DEFAULT_OPTIONS;
  /* Half of the budget is left to the continuation. */
  const newton_limits limits = {
      .max_iterations = (chosen.max_iterations + 1) / 2,
      .max_jacobians = chosen.max_iterations,
      .max_halvings = 0,
      .inexact = 0,
      .reuse_jacobian = memory->has_jacobian,
  };
  solver_info found = no_result();
  if (!all_finite(inputs, INPUTS) || !all_finite(x, N)) return finish(x, inputs, &found, info, work);
  work->updated_jacobians[0].factors = memory->jacobian;
  work->updated_jacobians[0].count = 0;
  if (!correct(&limits, inputs, x, work, &found) && !follow_last_turn(memory, &chosen, inputs, x, work, &found)) {
    found.status = SOLVER_LOST_TRACK;
    found.load_factor = 0;
    return finish(x, inputs, &found, info, work);
  }
  for (int i = 0; i < INPUTS; i++) memory->inputs[i] = inputs[i];
  memory->has_inputs = 1;
  memory->has_jacobian = 0;
  solver_status end = finish(x, inputs, &found, info, work);
  if (end == SOLVER_CONVERGED) end = derivatives(inputs, x, d_x_d_inputs, d_poses_d_inputs, work);
  if (end == SOLVER_CONVERGED) {
    memory->jacobian = work->updated_jacobians[0].factors;
    memory->has_jacobian = 1;
  }
  return end;
}
