/* Damped Newton with a Broyden-updated Jacobian, from an iterate that the caller gives.

   cosserat_casadi/numerics holds the same algorithm in Python: newton.py, broyden.py. */

static const newton_limits DAMPED_NEWTON = {
    .max_iterations = MAX_ITERATIONS,
    .max_jacobians = MAX_ITERATIONS,
    .max_halvings = MAX_HALVINGS,
    .inexact = 0,
    .reuse_jacobian = 0,
};

/* Applies the updates to a product with the inverse of the Jacobian: one rank-one update for each step and the next
   one. */
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

/* Completes the quasi-Newton step at an iterate from minus the inverse times the residual. The update is C. G.
   Broyden's (Math. Comp. 19, 1965, 577-593); its inverse is applied from the steps alone: C. T. Kelley, Iterative
   Methods for Linear and Nonlinear Equations, SIAM 1995, section 7.3. */
static void complete_step(const updated_jacobian *jacobian, real *step) {
  if (jacobian->count > 0) {
    const int last = jacobian->count - 1;
    const real share = 1 - dot(jacobian->steps[last], step) / jacobian->squares[last];
    const real factor = 1 / share;
    for (int i = 0; i < N; i++) step[i] *= factor;
  }
}

/* Returns the square of the step's length, which is not finite where the step is not. */
static real newton_step(const updated_jacobian *jacobian, const real *residual, real *step, workspace *work) {
  apply_inverse(jacobian, residual, step, work);
  complete_step(jacobian, step);
  return dot(step, step);
}

/* Minus the inverse times any vector, at an iterate with this residual, since the update of the last step needs the
   step that would follow. Returns zero if the result is not finite. */
static int response(const updated_jacobian *jacobian, const real *residual, const real *vector, real *result,
                    workspace *work) {
  apply_inverse(jacobian, vector, result, work);
  if (jacobian->count > 0 && isfinite(newton_step(jacobian, residual, work->next_step, work))) {
    const int last = jacobian->count - 1;
    const real share = dot(jacobian->steps[last], result) / jacobian->squares[last];
    for (int i = 0; i < N; i++) result[i] += work->next_step[i] * share;
  }
  return all_finite(result, N);
}

/* Whether a step of this length reduces the residual enough. */
static int serves(real length, real trial_norm, real norm) {
  return isfinite(trial_norm) && trial_norm <= (1 - SUFFICIENT_DECREASE * length) * norm;
}

/* Halves the step until the residual falls. Returns the accepted length, or zero; updates x, residual and norm. */
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

/* Place of the next step: behind the steps of the updates. */
static real *place_of_step(updated_jacobian *jacobian) { return jacobian->steps[jacobian->count]; }

/* Adds the step at that place to the updates; square is the square of its length. */
static void append_step(updated_jacobian *jacobian, real square) {
  jacobian->squares[jacobian->count] = square;
  jacobian->count++;
}

static newton_state begin_newton(const newton_limits *limits, const real *residual) {
  const newton_state state = {
      .result = {.status = SOLVER_MAX_ITERATIONS, .iterations = 0, .jacobians = 0, .damped = 0, .residual_norm = 0},
      .reuse_jacobian = limits->reuse_jacobian,
      .norm = norm_of(residual),
  };
  return state;
}

/* Whether Newton ends at unknowns of this norm, by what its result says. */
static int newton_ends(newton_state *state, const newton_limits *limits, real norm_of_x) {
  newton_result *result = &state->result;
  const real size = 1 + norm_of_x;
  result->residual_norm = state->norm / size;
  /* If the norm of the unknowns overflows, any residual would count as small. */
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

/* Decides after a step: share is its accepted length, zero if none; norm is that of the residual, square the square of
   the length of the whole step. Returns zero if Newton ends. */
static int weigh_step(newton_state *state, const newton_limits *limits, real square, real share, real norm,
                      updated_jacobian *jacobian) {
  const real previous_norm = state->norm;
  state->norm = norm;
  if (share == 0) {
    if (!state->reuse_jacobian) {
      state->result.status = SOLVER_SINGULAR;
      return 0;
    }
    state->reuse_jacobian = 0;
    return 1;
  }
  if (share < 1) {
    state->result.damped = 1;
    state->reuse_jacobian = 0;
    return 1;
  }
  /* The next step is about as much shorter than this one as the residual has fallen. */
  if (SQUARE_ROOT(square) * norm < limits->inexact * previous_norm) state->result.status = SOLVER_CONVERGED;
  append_step(jacobian, square);
  state->reuse_jacobian = norm <= REUSE_DECREASE * previous_norm && jacobian->count < MAX_REUSES;
  return 1;
}

/* Newton's method from x, with the residual there. Updates both, and leaves the last Jacobian. */
static newton_result newton(const loads *at, const newton_limits *limits, real *x, real *residual,
                            updated_jacobian *jacobian, workspace *work) {
  newton_state state = begin_newton(limits, residual);
  while (!newton_ends(&state, limits, norm_of(x))) {
    if (!state.reuse_jacobian) {
      expect_jacobian(&state, jacobian);
      if (!linearise(x, at, &jacobian->factors, work)) {
        state.result.status = SOLVER_NOT_FINITE;
        break;
      }
    }
    state.result.iterations++;
    real *step = place_of_step(jacobian);
    real norm = state.norm;
    real share = 0;
    const real square = newton_step(jacobian, residual, step, work);
    if (isfinite(square)) {
      /* A step of an old Jacobian is not halved: a new Jacobian is worth more. */
      const int max_halvings = state.reuse_jacobian ? 0 : limits->max_halvings;
      share = line_search(at, step, max_halvings, x, residual, &norm, work);
    }
    if (!weigh_step(&state, limits, square, share, norm, jacobian)) break;
  }
  return state.result;
}

static void count_work(solver_info *info, const newton_result *result) {
  info->iterations += result->iterations;
  info->jacobians += result->jacobians;
}
