/* Concentric tubes around the solver: translations in their range, and no turn or path that ends beyond a snap.

   Where a robot snaps the determinant of its Jacobian is zero, and beyond it, on the branch that leads back, it has the
   other sign. A solution on such a branch is near the last one, but no robot that is turned on comes to it. */

static solver_status out_of_range(solver_info *info) {
  if (info) {
    *info = no_result();
    info->status = SOLVER_OUT_OF_RANGE;
  }
  return SOLVER_OUT_OF_RANGE;
}

/* Of a factorised Jacobian; its diagonal holds inverse pivots. */
static real determinant_of(const jacobian_factors *jacobian) {
  real product = 1;
  if (!jacobian->regular) return 0;
  for (int k = 0; k < N; k++) {
    product /= jacobian->factors[k * N + k];
    if (jacobian->pivots[k] != k) product = -product;
  }
  return product;
}

static int sign_of(real value) { return (value > 0) - (value < 0); }


real tubes_determinant(const real *x, const real *inputs, solver_workspace *work) {
  const loads at = full_load(inputs);
  jacobian_factors *factors = &work->updated_jacobians[0].factors;
  if (!linearise(x, &at, factors, work)) return NAN;
  return determinant_of(factors);
}

solver_status tubes_solve(const real *inputs, real *x, solver_workspace *work, solver_info *info) {
  if (!in_range(inputs)) return out_of_range(info);
  const solver_status end = solver_solve(inputs, x, work, info);
  if (info && end == SOLVER_CONVERGED) info->determinant = tubes_determinant(x, inputs, work);
  return end;
}

int tubes_solve_batch(int count, const real *inputs, real *x, solver_workspace *workspaces, int workspace_count,
                      solver_info *info) {
  const int converged = solver_solve_batch(count, inputs, x, workspaces, workspace_count, info);
  for (int i = 0; i < count; i++) {
    const real *own = inputs + (size_t)i * INPUTS;
    /* None of these has converged: their steps are never called enough. */
    if (!in_range(own)) (void)out_of_range(info + i);
    else if (info[i].status == SOLVER_CONVERGED) {
      info[i].determinant = tubes_determinant(x + (size_t)i * N, own, workspaces);
    }
  }
  return converged;
}

solver_status tubes_follow(const real *from, const real *inputs, real *x, solver_workspace *work, solver_info *info) {
  solver_info found = no_result();
  if (!in_range(from) || !in_range(inputs)) return out_of_range(info);
  const int before = sign_of(tubes_determinant(x, from, work));
  solver_status end = solver_follow(from, inputs, x, work, &found);
  if (end == SOLVER_CONVERGED) {
    found.determinant = tubes_determinant(x, inputs, work);
    if (sign_of(found.determinant) != before) end = SOLVER_LOAD_STALLED;
    found.status = end;
  }
  if (info) *info = found;
  return end;
}

solver_status tubes_sensitivity(const real *inputs, const real *x, real *d_x_d_inputs, real *d_poses_d_inputs,
                                solver_workspace *work) {
  if (!in_range(inputs)) return SOLVER_OUT_OF_RANGE;
  return sensitivity(inputs, x, d_x_d_inputs, d_poses_d_inputs, work);
}

/* The determinant at the solution of a turn, whose Jacobian the memory is left with; 0 at a snap. */
static real determinant_at_end(const real *inputs, const real *x, int has_derivatives, solver_memory *memory, workspace *work) {
  if (!has_derivatives || !memory->has_jacobian) {
    const loads at = full_load(inputs);
    memory->has_jacobian = linearise(x, &at, &memory->jacobian, work) && memory->jacobian.regular;
    if (!memory->has_jacobian) return 0;
  }
  return determinant_of(&memory->jacobian);
}

solver_status tubes_track(const real *inputs, real *x, solver_memory *memory, const solver_options *options,
                          real *d_x_d_inputs, real *d_poses_d_inputs, solver_workspace *work, solver_info *info) {
  solver_info found = no_result();
  real kept[N];
  if (!in_range(inputs)) return out_of_range(info);
  memcpy(kept, x, sizeof kept);
  work->memory = *memory;
  solver_status end = solver_track(inputs, x, memory, options, d_x_d_inputs, d_poses_d_inputs, work, &found);
  if (end == SOLVER_CONVERGED || end == SOLVER_UNRESOLVED) {
    found.determinant = determinant_at_end(inputs, x, d_x_d_inputs || d_poses_d_inputs, memory, work);
    const int sign = sign_of(found.determinant);
    if (memory->sign != 0 && sign != memory->sign) {
      memcpy(x, kept, sizeof kept);
      *memory = work->memory;
      found.status = SOLVER_LOST_TRACK;
      found.load_factor = 0;
      end = SOLVER_LOST_TRACK;
    } else {
      memory->sign = sign;
    }
  }
  if (info) *info = found;
  return end;
}

void tubes_residual(const real *x, const real *inputs, real *residual, solver_workspace *work) {
  solver_residual(x, inputs, residual, work);
}

void tubes_residual_jacobian(const real *x, const real *inputs, real *jacobian, real *residual, solver_workspace *work) {
  solver_residual_jacobian(x, inputs, jacobian, residual, work);
}

void tubes_input_jacobian(const real *x, const real *inputs, real *d_residual_d_inputs, solver_workspace *work) {
  solver_input_jacobian(x, inputs, d_residual_d_inputs, work);
}
