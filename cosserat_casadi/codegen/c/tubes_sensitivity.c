/* Derivatives of an equilibrium of concentric tubes and of its tips with the inputs: one kernel gives what they follow from. */

/* Derivatives of the tips: what they change with the unknowns, times what these change with the inputs, and at the same
   unknowns. The kernel's columns hold all tips; each tip has a block of columns of its own. */
static void tips_by_inputs(const real *columns, const workspace *work, real *d_poses_d_inputs) {
  enum { ROWS = POSES * POSE_SIZE };
  for (int input = 0; input < INPUTS; input++) {
    for (int pose = 0; pose < POSES; pose++) {
      real *target = d_poses_d_inputs + (pose * INPUTS + input) * POSE_SIZE;
      const int first = pose * POSE_SIZE;
      for (int i = 0; i < POSE_SIZE; i++) {
        real sum = work->d_poses_d_inputs[input * ROWS + first + i];
        for (int k = 0; k < N; k++) sum += work->d_poses_d_x[k * ROWS + first + i] * columns[input * N + k];
        target[i] = sum;
      }
    }
  }
}

/* Derivatives of the solution by the implicit function theorem; leaves the factorised Jacobian in updated_jacobians[0].
   Writes nothing unless it returns CONVERGED. Where none are wanted the Jacobian is all. */
static solver_status derivatives(const real *inputs, const real *x, real *d_x_d_inputs, real *d_poses_d_inputs,
                                 workspace *work) {
  jacobian_factors *factors = &work->updated_jacobians[0].factors;
  real *columns = work->d_x_d_inputs;
  work->updated_jacobians[0].count = 0;
  if (!d_x_d_inputs && !d_poses_d_inputs) {
    const loads at = full_load(inputs);
    if (!linearise(x, &at, factors, work)) return SOLVER_NOT_FINITE;
    return factors->regular ? SOLVER_CONVERGED : SOLVER_SINGULAR;
  }
  sensitivity_at(x, inputs, factors->factors, columns, work);
  if (!all_finite(factors->factors, N * N)) return SOLVER_NOT_FINITE;
  factors->regular = factorise(factors->factors, factors->pivots);
  if (!factors->regular) return SOLVER_SINGULAR;
  for (int j = 0; j < INPUTS; j++) {
    real *column = columns + j * N;
    for (int i = 0; i < N; i++) column[i] = -column[i];
    back_substitute(factors, column, work);
  }
  if (!all_finite(columns, N * INPUTS)) return SOLVER_SINGULAR;
  if (d_x_d_inputs) memcpy(d_x_d_inputs, columns, (size_t)N * INPUTS * sizeof *columns);
  if (d_poses_d_inputs) tips_by_inputs(columns, work, d_poses_d_inputs);
  return SOLVER_CONVERGED;
}

static solver_status sensitivity(const real *inputs, const real *x, real *d_x_d_inputs, real *d_poses_d_inputs,
                                 workspace *work) {
  const real size = 1 + norm_of(x);
  if (!all_finite(inputs, INPUTS) || !isfinite(size)) return SOLVER_NOT_FINITE;
  const loads at = full_load(inputs);
  residual_at(x, &at, work->trial_residual, work);
  if (!(norm_of(work->trial_residual) <= 10 * TOLERANCE * size)) return SOLVER_NOT_IN_EQUILIBRIUM;
  return derivatives(inputs, x, d_x_d_inputs, d_poses_d_inputs, work);
}
