/* Derivatives of an equilibrium and its poses with the inputs.

   Uses of the equations: linearise_by_inputs, pose_derivatives_at. */

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

/* Derivatives of the solution by the implicit function theorem; leaves the factorised Jacobian in updated_jacobians[0].
   Writes nothing unless it returns CONVERGED. d_x_d_inputs may be its place in the workspace. If no derivatives are
   wanted, it computes only the Jacobian. */
static solver_status derivatives(const real *inputs, const real *x, real *d_x_d_inputs, real *d_poses_d_inputs,
                                 workspace *work) {
  updated_jacobian *jacobian = work->updated_jacobians;
  real *columns = work->d_x_d_inputs;
  const loads at = full_load(inputs);
  const int wanted = d_x_d_inputs || d_poses_d_inputs;
  jacobian->count = 0;
  if (!linearise_by_inputs(x, &at, &jacobian->factors, wanted ? columns : 0, work)) return SOLVER_NOT_FINITE;
  if (!jacobian->factors.regular) return SOLVER_SINGULAR;
  if (!wanted) return SOLVER_CONVERGED;
  for (int j = 0; j < INPUTS; j++) {
    real *column = columns + j * N;
    for (int i = 0; i < N; i++) column[i] = -column[i];
    back_substitute(&jacobian->factors, column, work);
  }
  if (!all_finite(columns, N * INPUTS)) return SOLVER_SINGULAR;
  if (d_x_d_inputs && d_x_d_inputs != columns) memcpy(d_x_d_inputs, columns, (size_t)N * INPUTS * sizeof *columns);
  if (!d_poses_d_inputs) return SOLVER_CONVERGED;
  for (int i = 0; i < POSES; i++) {
    real *pose = d_poses_d_inputs + i * POSE_SIZE * INPUTS;
    pose_derivatives_at(i, x, inputs, pose, work);
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
