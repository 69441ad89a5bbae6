/* Solver of the equilibrium equations: damped Newton with a Broyden-updated Jacobian (solver_newton.c), inside natural
   continuation in the load or in the inputs (solver_path.c). See the library's header for what each public function
   promises. */

/* Distance of two shapes by strains and poses of frames. Multipliers and tensions may jump if a stiff rod moves by a
   hair, and say nothing about the branch. */
static real shape_distance(const real *a, const real *b) {
  real sum = 0;
  for (int i = 0; i < N; i++) {
    if (IS_SHAPE[i]) sum += (a[i] - b[i]) * (a[i] - b[i]);
  }
  return SQUARE_ROOT(sum);
}

/* Newton at the full load from x, the solution for the last inputs. Returns zero and restores x if the result strays so
   far that it may be another branch, or lies beyond something thin. Leaves the last Jacobian in
   updated_jacobians[0]. */
static int correct(const newton_limits *limits, const real *before, const real *inputs, real *x, workspace *work,
                   solver_info *info) {
  real *trial = work->points[0].x;
  real *residual = work->points[0].residual;
  const loads at = full_load(inputs);
  memcpy(trial, x, N * sizeof *x);
  residual_at(trial, &at, residual, work);
  const newton_result result = newton(&at, limits, trial, residual, work->updated_jacobians, work);
  count_work(info, &result);
  if (result.status != SOLVER_CONVERGED || result.damped) return 0;
  if (shape_distance(trial, x) > SAME_BRANCH || is_beyond(x, before, trial, inputs, work)) return 0;
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
      .status = SOLVER_NOT_FINITE, .iterations = 0, .jacobians = 0, .residual_norm = 0, .load_factor = 0,
      .error_estimate = -1};
  return none;
}

/* Reports an x that is not the solution: the residual at the wanted inputs, wherever the path ended. */
static real residual_left(const real *x, const real *inputs, workspace *work) {
  real *residual = work->points[0].residual;
  const loads at = full_load(inputs);
  residual_at(x, &at, residual, work);
  return norm_of(residual) / (1 + norm_of(x));
}

/* With too few nodes for a bend the solution of the equations is no solution of the rod. The Jacobian is the one that
   Newton left at x, or null. */
static solver_status finish(const real *x, const real *inputs, updated_jacobian *jacobian, solver_info *found,
                            solver_info *info, workspace *work) {
  if (found->status == SOLVER_CONVERGED && !(resolution_index(x, inputs, work) <= 1)) found->status = SOLVER_UNRESOLVED;
  found->status = within_limits(found->status, x, inputs, work);
  const int solved = found->status == SOLVER_CONVERGED || found->status == SOLVER_UNRESOLVED;
  if (!solved) found->residual_norm = residual_left(x, inputs, work);
#ifdef SOLVER_MISSING
  if (info && found->status == SOLVER_CONVERGED) found->error_estimate = estimated_error(x, inputs, jacobian, work);
#else
  (void)jacobian;
#endif
  if (info) *info = *found;
  return found->status;
}

solver_status solver_solve(const real *inputs, real *x, solver_workspace *work, solver_info *info) {
  solver_info found = no_result();
  updated_jacobian *jacobian = 0;
  if (all_finite(inputs, INPUTS)) {
    const int warm = all_finite(x, N) && !is_zero(x);
    if (!warm || !correct(&DAMPED_NEWTON, inputs, inputs, x, work, &found)) {
      jacobian = solve_from_unloaded(inputs, x, work, &found);
    } else if (found.jacobians > 0) {
      jacobian = work->updated_jacobians;
    }
  }
  return finish(x, inputs, jacobian, &found, info, work);
}

solver_status solver_follow(const real *from, const real *inputs, real *x, solver_workspace *work, solver_info *info) {
  solver_info found = no_result();
  updated_jacobian *jacobian = 0;
  const load_path path = {.grows_load = 0, .is_paced = 0, .from = from, .to = inputs};
  if (all_finite(from, INPUTS) && all_finite(inputs, INPUTS) && all_finite(x, N)) {
    const newton_result start = start_path(&path, &DAMPED_NEWTON, x, work);
    count_work(&found, &start);
    found.status = start.status;
    if (start.status == SOLVER_CONVERGED) jacobian = follow_to_the_end(&path, 1, x, work, &found);
  }
  return finish(x, inputs, jacobian, &found, info, work);
}

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
