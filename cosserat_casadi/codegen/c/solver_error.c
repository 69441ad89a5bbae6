/* The error of an answer, from modes and intervals that its model lacks. Each missing mode gives way by what the balance of
   a richer model lacks in it, as elasticity alone would have it; the Jacobian of the answer tells how its own unknowns
   follow. A few such sweeps are Newton's corrections with the richer model.

   cosserat_casadi/equilibrium/answer_error.py holds the same in Python, docs/theory.md, section 10, derives it.

   Uses of the equations: richer_balance_at, richer_change_at. */

enum { MISSING = SOLVER_MISSING };

/* One sweep of the corrections in the workspace. Returns the change of what is watched. */
static real sweep(const real *x, const real *inputs, const updated_jacobian *jacobian, workspace *work) {
  const real *elastic_step = work->balance;
  const real *missing_step = elastic_step + N;
  const real *residual = missing_step + MISSING;
  real *step = work->correction;
  richer_balance_at(x, work->known_correction, work->missing, inputs, work->balance, work);
  for (int i = 0; i < N; i++) work->known_correction[i] += elastic_step[i];
  for (int i = 0; i < MISSING; i++) work->missing[i] += missing_step[i];
  richer_balance_at(x, work->known_correction, work->missing, inputs, work->balance, work);
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
  real before = -1;
  jacobian->count = 0;
  if (!linearise(x, &at, &jacobian->factors, work)) return 1;
  memset(work->known_correction, 0, sizeof work->known_correction);
  memset(work->missing, 0, sizeof work->missing);
  for (int k = 0; k < ERROR_SWEEPS; k++) {
    const real change = sweep(x, inputs, jacobian, work);
    if (!isfinite(change)) break;
    const int settled = before >= 0 && ABSOLUTE(change - before) <= ERROR_SETTLED * change;
    if (settled) {
      return ERROR_SAFETY * (change + rest_of_series(x, inputs, change, work)) + ERROR_FLOOR;
    }
    /* A look that leaves the answer within its tolerance need not be repeated. */
    if (change <= ERROR_ENOUGH) return ERROR_SAFETY * change + ERROR_FLOOR;
    before = change;
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
