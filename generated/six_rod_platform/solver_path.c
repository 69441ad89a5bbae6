/* Natural continuation in the load, from the unloaded scene, or in the inputs, from an equilibrium.

   cosserat_casadi/numerics/continuation.py holds the same algorithm in Python. */

static const path_limits LONG_PATH = {
    .max_steps = MAX_STEPS,
    .max_iterations = MAX_STEPS * (MAX_ITERATIONS + 1),
    .first_step = 0,
};

/* Share of the loads at t: t, or 1 - (1 - t)^3 on a paced path. */
static real load_factor_at(const load_path *path, real t) {
  const real rest = 1 - t;
  return PACES && path->is_paced ? 1 - rest * rest * rest : t;
}

/* The loads at t; the inputs lie in the workspace until the next call. */
static loads loads_at(const load_path *path, real t, workspace *work) {
  loads at = {work->path_inputs, 1};
  if (path->grows_load) {
    at.inputs = path->to;
    at.load_factor = load_factor_at(path, t);
    return at;
  }
  /* The interpolation is exact at both ends, however different in size both are. */
  for (int i = 0; i < INPUTS; i++) work->path_inputs[i] = (1 - t) * path->from[i] + t * path->to[i];
  return at;
}

/* Length of a change of the unknowns: strains and poses count whole, forces by a share, none on a paced path. */
static real step_length(const real *step, int is_paced) {
  real sum = 0;
  for (int i = 0; i < N; i++) {
    const real weighted = PACES && is_paced && !IS_SHAPE[i] ? 0 : step[i] * STEP_WEIGHTS[i];
    sum += weighted * weighted;
  }
  return SQUARE_ROOT(sum);
}

/* Whether a correction leaves a point on the path and not on another. */
static int is_small(const progress *now, const real *correction, const real *predicted) {
  return step_length(correction, now->is_paced) <= (real)0.3 + (real)0.5 * step_length(predicted, now->is_paced);
}

/* The response to the rate of the residual. Returns zero if the rate is not finite, or the Jacobian not regular. */
static void set_tangent(path_point *point, int sound, const updated_jacobian *jacobian, workspace *work) {
  if (!sound || !response(jacobian, point->residual, work->rate, point->tangent, work)) {
    memset(point->tangent, 0, sizeof point->tangent);
  }
}

/* dx/dt at a point of the path, with Newton's last Jacobian there; zero without it. Returns the number of new
   Jacobians. */
static int tangent_at(const load_path *path, path_point *point, int has_jacobian, updated_jacobian *jacobian,
                      workspace *work) {
  const loads at = loads_at(path, point->t, work);
  const real rest = 1 - point->t;
  const real load_factor_rate = path->is_paced ? (real)PACE * rest * rest : path->grows_load ? 1 : 0;
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
static void predict(const path_point *point, const path_point *previous, real step, int is_paced, real *predicted,
                    real *bent) {
  for (int i = 0; i < N; i++) predicted[i] = step * point->tangent[i];
  if (!previous) return;
  const real interval = point->t - previous->t;
  const real share = step / interval;
  for (int i = 0; i < N; i++) {
    const real change = point->x[i] - previous->x[i];
    const real cubic = interval * (point->tangent[i] + previous->tangent[i]) - 2 * change;
    bent[i] = share * share * (cubic + interval * point->tangent[i] - change) + share * share * share * cubic;
  }
  if (step_length(bent, is_paced) > MAX_CURVATURE_SHARE * step_length(predicted, is_paced)) return;
  for (int i = 0; i < N; i++) predicted[i] += bent[i];
}

/* Length of the next step from the wanted one; zero if it is too short to go on. */
static real admissible_step(const progress *now, real wanted) {
  const real rest = 1 - now->point->t;
  const real length = step_length(now->point->tangent, now->is_paced);
  real step = wanted > rest ? rest : wanted;
  if (step * length > MAX_STEP_LENGTH) step = MAX_STEP_LENGTH / length;
  return step < MIN_STEP && step < rest ? 0 : step;
}

/* Writes the predicted next point. */
static void predict_next(const progress *now, real step, workspace *work) {
  path_point *next = now->next;
  const real end = now->point->t + step;
  next->t = end > 1 - (real)1e-12 ? 1 : end;
  predict(now->point, now->previous, step, now->is_paced, work->predicted, work->correction);
  for (int i = 0; i < N; i++) next->x[i] = now->point->x[i] + work->predicted[i];
}

/* Returns zero if the present Jacobian predicts too large a correction of the predicted point with this residual. This
   question costs far less than a new Jacobian. */
static int is_promising(const progress *now, workspace *work) {
  if (!now->has_jacobian) return 1;
  if (!response(now->jacobian, now->point->residual, now->next->residual, work->correction, work)) return 1;
  return is_small(now, work->correction, work->predicted);
}

/* Corrector: Newton at the next point, inexact on the way and exact at the end, without damping: far from the path
   Newton would find another equilibrium. */
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

static int is_trusted(const load_path *path, const newton_result *result, const progress *now, workspace *work) {
  if (result->status != SOLVER_CONVERGED || result->damped) return 0;
  for (int i = 0; i < N; i++) work->correction[i] = now->next->x[i] - now->point->x[i] - work->predicted[i];
  return is_small(now, work->correction, work->predicted) && !is_barred(path, now, work);
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
      .is_paced = 0,
      .step = 0,
  };
  return now;
}

/* Continues from the equilibrium at t = 0 in points[0] towards t = 1. points[0] has its tangent, updated_jacobians[0]
   its Jacobian if known. Returns the last point, which is inexact unless it is the end, and the next step, zero if none
   is long enough. */
static progress follow_path(const load_path *path, const path_limits *limits, int has_jacobian, workspace *work,
                            solver_info *info) {
  progress now = begin_path(has_jacobian, work);
  now.is_paced = path->is_paced;
  real step = path->grows_load ? FIRST_STEP : 1;
  if (path->is_paced) step /= (real)PACE;
  if (limits->first_step > 0) step = limits->first_step;
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
    if (!is_trusted(path, &result, &now, work)) {
      step /= 2;
      continue;
    }
    if (now.next->t < 1) {
      if (result.jacobians <= GROW_BELOW) step *= 2;
      /* Small corrections turn large forces: Newton's Jacobian is no guide. */
      const int known = result.jacobians > 0 && !path->is_paced;
      info->jacobians += tangent_at(path, now.next, known, now.spare, work);
    }
    accept_next(&now);
    if (now.point->t == 1) {
      now.has_jacobian = result.jacobians > 0;
      info->status = SOLVER_CONVERGED;
      info->residual_norm = result.residual_norm;
      break;
    }
  }
  info->load_factor = load_factor_at(path, now.point->t);
  now.step = step;
  return now;
}

/* Follows a path to its end; x becomes the last point, as near to equilibrium as Newton brings it. Returns Newton's
   last Jacobian there, or null. */
static updated_jacobian *follow_to_the_end(const load_path *path, int has_jacobian, real *x, workspace *work,
                                           solver_info *info) {
  const progress end = follow_path(path, &LONG_PATH, has_jacobian, work, info);
  memcpy(x, end.point->x, N * sizeof *x);
  if (end.point->t == 1) return end.has_jacobian ? end.jacobian : 0;
  const loads at = loads_at(path, end.point->t, work);
  const newton_result result = newton(&at, &DAMPED_NEWTON, x, end.point->residual, end.spare, work);
  count_work(info, &result);
  info->status = SOLVER_LOAD_STALLED;
  return 0;
}

static updated_jacobian *grow_loads(const real *inputs, int is_paced, real *x, workspace *work, solver_info *info) {
  const load_path path = {.grows_load = 1, .is_paced = is_paced, .from = inputs, .to = inputs};
  path_point *first = work->points;
  memset(x, 0, N * sizeof *x);
  memset(first, 0, sizeof *first);
  unloaded_tangent(inputs, first->tangent, work);
  if (!isfinite(norm_of(first->tangent))) {
    info->status = SOLVER_NOT_FINITE;
    return 0;
  }
  for (int i = 0; is_paced && i < N; i++) first->tangent[i] *= (real)PACE;
  return follow_to_the_end(&path, 0, x, work, info);
}

/* Tension may keep the steps from the full load: then the shape bounds them. Returns Newton's last Jacobian at the
   solution, or null. */
static updated_jacobian *solve_from_unloaded(const real *inputs, real *x, workspace *work, solver_info *info) {
  updated_jacobian *jacobian = grow_loads(inputs, 0, x, work, info);
  if (!PACES || info->status != SOLVER_LOAD_STALLED || info->load_factor <= NEARLY_LOADED) return jacobian;
  return grow_loads(inputs, 1, x, work, info);
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
  if (result.status == SOLVER_CONVERGED && is_beyond(x, at.inputs, first->x, at.inputs, work)) {
    result.status = SOLVER_NOT_IN_EQUILIBRIUM;
  }
  if (result.status == SOLVER_CONVERGED) {
    result.jacobians += tangent_at(path, first, result.jacobians > 0, jacobian, work);
  }
  return result;
}
