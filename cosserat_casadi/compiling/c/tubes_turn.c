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

/* Determinant of a factorised Jacobian, whose diagonal holds inverse pivots. */
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

/* Solves in steps from straight tubes that keep the sign of the determinant and twist the tubes by at most SAME_BRANCH
   each. Nearly opposed tubes may bend to either side, or stay between, which is unstable; a long step may reach any of
   the three. Returns zero and restores x if the steps do not reach the inputs: exactly opposed tubes stay opposed. */
static int solve_with_care(const real *inputs, real *x, workspace *work, solver_info *info) {
  static const newton_limits limits = {
      .max_iterations = MAX_ITERATIONS, .max_jacobians = MAX_ITERATIONS, .max_halvings = 0, .inexact = 0,
      .reuse_jacobian = 0};
  path_point *point = work->points;
  updated_jacobian *jacobian = work->updated_jacobians;
  real *trial = work->points[1].x;
  real step = (real)0.25;
  real residual_norm = 0;
  memset(point, 0, sizeof *point);
  for (int k = 0; k < MAX_STEPS && point->t < 1 && step >= MIN_STEP; k++) {
    const real end = point->t + step > 1 ? 1 : point->t + step;
    const loads at = {inputs, end};
    memcpy(trial, point->x, sizeof point->x);
    residual_at(trial, &at, work->points[1].residual, work);
    const newton_result result = newton(&at, &limits, trial, work->points[1].residual, jacobian, work);
    count_work(info, &result);
    const int is_near = result.status == SOLVER_CONVERGED && shape_distance(trial, point->x) <= SAME_BRANCH;
    if (!is_near || !linearise(trial, &at, &jacobian->factors, work) || !(determinant_of(&jacobian->factors) > 0)) {
      step /= 2;
      continue;
    }
    memcpy(point->x, trial, sizeof point->x);
    point->t = end;
    residual_norm = result.residual_norm;
    step *= 2;
  }
  if (point->t < 1) return 0;
  memcpy(x, point->x, sizeof point->x);
  info->status = SOLVER_CONVERGED;
  info->residual_norm = residual_norm;
  info->load_factor = 1;
  return 1;
}

solver_status tubes_solve(const real *inputs, real *x, solver_workspace *work, solver_info *info) {
  solver_info found = no_result();
  if (!in_range(inputs, work)) return out_of_range(info);
  const int is_cold = !all_finite(x, N) || is_zero(x);
  solver_status end = solver_solve(inputs, x, work, &found);
  const int is_resolved = end != SOLVER_UNRESOLVED && end != SOLVER_NOT_FINITE;
  if (end == SOLVER_CONVERGED) found.determinant = tubes_determinant(x, inputs, work);
  if (is_cold && is_resolved && !(found.determinant > 0) && solve_with_care(inputs, x, work, &found)) {
    end = finish(x, inputs, 0, &found, &found, work);
    found.determinant = tubes_determinant(x, inputs, work);
  }
  if (info && end == SOLVER_CONVERGED) found.error_estimate = estimated_error(x, inputs, work);
  if (info) *info = found;
  return end;
}

solver_status tubes_follow(const real *from, const real *inputs, real *x, solver_workspace *work, solver_info *info) {
  solver_info found = no_result();
  if (!in_range(from, work) || !in_range(inputs, work)) return out_of_range(info);
  const int before = sign_of(tubes_determinant(x, from, work));
  solver_status end = solver_follow(from, inputs, x, work, &found);
  if (end == SOLVER_CONVERGED) {
    found.determinant = tubes_determinant(x, inputs, work);
    if (sign_of(found.determinant) != before) end = SOLVER_LOAD_STALLED;
    found.status = end;
  }
  if (info && end == SOLVER_CONVERGED) found.error_estimate = estimated_error(x, inputs, work);
  if (info) *info = found;
  return end;
}

solver_status tubes_solve_sensitivity(const real *inputs, const real *x, real *d_x_d_inputs, real *d_poses_d_inputs,
                                      solver_workspace *work) {
  if (!in_range(inputs, work)) return SOLVER_OUT_OF_RANGE;
  return solver_solve_sensitivity(inputs, x, d_x_d_inputs, d_poses_d_inputs, work);
}

/* The determinant at the solution of a turn, 0 at a snap; leaves the Jacobian in the memory. */
static real determinant_at_end(const real *inputs, const real *x, int has_derivatives, solver_memory *memory,
                               workspace *work) {
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
  if (!in_range(inputs, work)) return out_of_range(info);
  memcpy(kept, x, sizeof kept);
  work->memory = *memory;
  solver_status end = solver_track(inputs, x, memory, options, d_x_d_inputs, d_poses_d_inputs, work, &found);
  if (end == SOLVER_CONVERGED) {
    found.determinant = determinant_at_end(inputs, x, d_x_d_inputs || d_poses_d_inputs, memory, work);
    const int sign = sign_of(found.determinant);
    if (memory->sign != 0 && sign != memory->sign) {
      memcpy(x, kept, sizeof kept);
      *memory = work->memory;
      found.status = SOLVER_LOST_TRACK;
      found.residual_norm = residual_left(x, inputs, work);
      found.load_factor = 0;
      end = SOLVER_LOST_TRACK;
    } else {
      memory->sign = sign;
    }
  }
  if (info) *info = found;
  return end;
}
