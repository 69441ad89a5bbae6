/* The error of an answer, from modes and intervals that its model lacks. Each missing mode gives way by what the balance of
   a richer model lacks in it, as elasticity alone would have it; the Jacobian of the answer tells how its own unknowns
   follow. A few such sweeps are Newton's corrections with the richer model.

   cosserat_casadi/equilibrium/answer_error.py holds the same in Python, docs/theory.md, section 10, derives it.

   Uses of the equations: richer_balance_at, richer_change_at. */

enum { MISSING = SOLVER_MISSING };

static real norm_of_missing(const real *missing) {
  real sum = 0;
  for (int i = 0; i < MISSING; i++) sum += missing[i] * missing[i];
  return SQUARE_ROOT(sum);
}

/* Whether a step of the missing modes is at most half as long as the one before it, or rounding. A wall that they run into
   is not in their stiffness: then they bounce, and what is watched may settle by chance. */
static int contracts(real before, real step) {
  return step <= ERROR_CONTRACTING * before || step <= 10 * TOLERANCE;
}

/* The step of the missing modes that the corrections in the workspace call for; the balance stays in the workspace. */
static real next_missing_step(const real *x, const real *inputs, workspace *work) {
  richer_balance_at(x, work->known_correction, work->missing, inputs, work->balance, work);
  return norm_of_missing(work->balance + N);
}

/* One sweep of the corrections in the workspace, from the balance that is there. Returns the change of what is watched, and
   sets next to the length of the step that the missing modes would make before the unknowns of the answer follow. */
static real sweep(const real *x, const real *inputs, const updated_jacobian *jacobian, real *next, workspace *work) {
  const real *elastic_step = work->balance;
  const real *missing_step = elastic_step + N;
  const real *residual = missing_step + MISSING;
  real *step = work->correction;
  for (int i = 0; i < N; i++) work->known_correction[i] += elastic_step[i];
  for (int i = 0; i < MISSING; i++) work->missing[i] += missing_step[i];
  *next = next_missing_step(x, inputs, work);
  apply_inverse(jacobian, residual, step, work);
  for (int i = 0; i < N; i++) work->known_correction[i] += step[i];
  return richer_change_at(x, work->known_correction, work->missing, inputs, work);
}

/* What modes beyond those of the richer model would add: the rest of a geometric series whose ratio is the part of the two
   highest degrees in the whole change. */
static real rest_of_series(const real *x, const real *inputs, real change, workspace *work) {
  if (change <= ERROR_FLOOR) return 0;
  for (int i = 0; i < MISSING; i++) work->fewer[i] = IS_AMONG_LAST[i] ? 0 : work->missing[i];
  const real fewer = richer_change_at(x, work->known_correction, work->fewer, inputs, work);
  const real last = ABSOLUTE(change - fewer);
  real ratio = last / change;
  if (ratio < ERROR_FASTEST) ratio = ERROR_FASTEST;
  if (!(ratio <= ERROR_SLOWEST)) ratio = ERROR_SLOWEST;
  return last * ratio / (1 - ratio);
}

/* Estimated error of an equilibrium; the whole length, 1, where the corrections do not settle. What the corrections do to
   a tip nearly cancels, so that the Jacobian is made anew: that of the last Newton step is not exact enough. */
static real estimated_error(const real *x, const real *inputs, workspace *work) {
  updated_jacobian *jacobian = work->updated_jacobians;
  const loads at = full_load(inputs);
  real change_before = -1;
  real step_before = -1;
  jacobian->count = 0;
  if (!linearise(x, &at, &jacobian->factors, work)) return 1;
  memset(work->known_correction, 0, sizeof work->known_correction);
  memset(work->missing, 0, sizeof work->missing);
  for (int k = 0; k < ERROR_SWEEPS; k++) {
    real next;
    const real step = next_missing_step(x, inputs, work);
    const int is_first = k == 0;
    if (!is_first && !contracts(step_before, step)) break;
    const real change = sweep(x, inputs, jacobian, &next, work);
    if (!isfinite(change)) break;
    const int settled = !is_first && ABSOLUTE(change - change_before) <= ERROR_SETTLED * change;
    if (settled) {
      return ERROR_SAFETY * (change + rest_of_series(x, inputs, change, work)) + ERROR_FLOOR;
    }
    /* A look that leaves the answer within its tolerance need not be repeated. */
    if (change <= ERROR_ENOUGH && (!is_first || contracts(step, next))) return ERROR_SAFETY * change + ERROR_FLOOR;
    change_before = change;
    step_before = step;
  }
  return 1;
}

solver_status solver_error_estimate(const real *inputs, const real *x, real *error_estimate, solver_workspace *work) {
  const real size = 1 + norm_of(x);
  const loads at = full_load(inputs);
  if (!all_finite(inputs, INPUTS) || !isfinite(size)) return SOLVER_NOT_FINITE;
  residual_at(x, &at, work->trial_residual, work);
  if (!(norm_of(work->trial_residual) <= 10 * TOLERANCE * size)) return SOLVER_NOT_IN_EQUILIBRIUM;
  *error_estimate = estimated_error(x, inputs, work);
  return SOLVER_CONVERGED;
}
