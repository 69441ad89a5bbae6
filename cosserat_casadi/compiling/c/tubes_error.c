/* The error of an answer: the distance of its tips from the tips with half as many steps, whose error is far larger.
   The equilibrium with half of the steps is one step of Newton's method away, with the Jacobian of the answer.

   cosserat_casadi/tubes/tube_solve.py solves with both numbers of steps, and compares the same.

   Uses of the equations: halved_residual_at, halved_change_at. */

/* Estimated error of an equilibrium whose factorised Jacobian is in updated_jacobians[0]; it is the whole length, 1, if
   that is singular, or the tips with half of the steps are not numbers. */
static real estimated_error(const real *x, const real *inputs, workspace *work) {
  const jacobian_factors *jacobian = &work->updated_jacobians[0].factors;
  real *step = work->correction;
  if (!jacobian->regular) return 1;
  halved_residual_at(x, inputs, step, work);
  for (int i = 0; i < N; i++) step[i] = -step[i];
  back_substitute(jacobian, step, work);
  const real change = halved_change_at(x, step, inputs, work);
  return isfinite(change) ? change : 1;
}

solver_status tubes_error_estimate(const real *inputs, const real *x, real *error_estimate, solver_workspace *work) {
  const loads at = full_load(inputs);
  const real size = 1 + norm_of(x);
  if (!all_finite(inputs, INPUTS) || !isfinite(size)) return SOLVER_NOT_FINITE;
  if (!in_range(inputs, work)) return SOLVER_OUT_OF_RANGE;
  residual_at(x, &at, work->trial_residual, work);
  if (!(norm_of(work->trial_residual) <= 10 * TOLERANCE * size)) return SOLVER_NOT_IN_EQUILIBRIUM;
  if (!linearise(x, &at, &work->updated_jacobians[0].factors, work)) return SOLVER_NOT_FINITE;
  *error_estimate = estimated_error(x, inputs, work);
  return SOLVER_CONVERGED;
}
