/* Newton's method for the stages of a step, with one Jacobian and Broyden's updates of it. Steps of libraries include it
   (step.c), and those of simulated motions (controlled_steps.c).

   cosserat_casadi/numerics/stage_newton.py holds the same algorithm in Python.

   Uses of the step: N unknowns in each of STAGES, STAGED in all of them, IS_SHAPE and DISPLACEMENTS of each unknown,
   STAGE_MATRIX; residuals_of_stages, corrections_of; in the workspace stage_residuals, stage_corrections, stage_changes,
   taken, duals. Gives: weighted_length, solve_stages. */

/* The largest change of position, over the length, of changes at so many instants; not finite where one of them is not. */
static real weighted_length(const real *change, int instants, const workspace *work) {
  real largest = 0;
  (void)work;
  for (int k = 0; k < instants; k++) {
    for (int i = 0; i < N; i++) {
      const real size = ABSOLUTE(change[k * N + i]) * DISPLACEMENTS[i];
      if (!isfinite(size)) return size;
      largest = larger(largest, size);
    }
  }
  return largest;
}

/* Changes of h v by changes of h^2 a. */
static void velocity_changes(const real *corrections, real *changes, const workspace *work) {
  (void)work;
  for (int stage = 0; stage < STAGES; stage++) {
    for (int i = 0; i < N; i++) {
      real sum = STAGE_MATRIX[stage][0] * corrections[i];
      for (int k = 1; k < STAGES; k++) sum += STAGE_MATRIX[stage][k] * corrections[k * N + i];
      changes[stage * N + i] = sum;
    }
  }
}

/* Four sums, none of which waits for the others. */
static real inner_product(const real *a, const real *b, int count) {
  real sums[4] = {0, 0, 0, 0};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    sums[0] += a[i] * b[i];
    sums[1] += a[i + 1] * b[i + 1];
    sums[2] += a[i + 2] * b[i + 2];
    sums[3] += a[i + 3] * b[i + 3];
  }
  for (; i < count; i++) sums[0] += a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/* Broyden's updates, applied from the corrections taken so far: C. T. Kelley, Iterative Methods for Linear and Nonlinear
   Equations, SIAM 1995, section 7.3. */
static void apply_step_updates(int count, real *corrections, const workspace *work) {
  for (int k = 0; k + 1 < count; k++) {
    const real share = inner_product(work->duals[k], corrections, STAGED);
    for (int i = 0; i < STAGED; i++) corrections[i] += share * work->taken[k + 1][i];
  }
  if (count > 0) {
    /* The last update contains the correction that it is applied to. */
    const real share = 1 - inner_product(work->duals[count - 1], corrections, STAGED);
    for (int i = 0; i < STAGED; i++) corrections[i] /= share;
  }
}

/* Stores a correction for the updates, with its changes of h v, which are overwritten. */
static void take_correction(int count, const real *corrections, real *changes, workspace *work) {
  real *dual = work->duals[count];
  real square = 0;
  memcpy(work->taken[count], corrections, (size_t)STAGED * sizeof *corrections);
  for (int stage = 0; stage < STAGES; stage++) {
    for (int i = 0; i < N; i++) {
      const real weight = DISPLACEMENTS[i];
      real *change = changes + stage * N + i;
      *change *= weight;
      square += *change * *change;
      *change *= weight;
    }
  }
  for (int stage = 0; stage < STAGES; stage++) {
    for (int i = 0; i < N; i++) {
      real sum = STAGE_MATRIX[0][stage] * changes[i];
      for (int k = 1; k < STAGES; k++) sum += STAGE_MATRIX[k][stage] * changes[k * N + i];
      dual[stage * N + i] = sum / square;
    }
  }
}

typedef enum { ITERATES, CONVERGES, DIVERGES } newton_course;

/* Decides how the iteration goes on after a correction of this length; see stage_newton.py. */
static newton_course course_of(real length, real longest, real contraction, real allowed, real *left) {
  const real expected = larger(contraction, LEAST_CONTRACTION);
  *left = contraction > 0 && contraction < 1 ? length * expected / (1 - expected) : length;
  if (length <= allowed) return CONVERGES;
  if (contraction > 0 && length >= DIVERGING * longest) return DIVERGES;
  if (contraction > 0 && contraction < 1 && *left <= allowed) return CONVERGES;
  return ITERATES;
}

/* Newton's method from a guess of the unknowns of the stages, which it updates. It ends when the remaining displacement
   over the length is below the bound, or after so many iterations. Gives the ratio of the last two corrections, 0 after
   one. */
static solver_motion_status solve_stages(const step_start *start, const stage_factors *factors, real allowed, int most,
                                         real *unknowns, real *contraction, workspace *work, solver_step_info *info) {
  const real to_acceleration = 1 / (start->size * start->size);
  real *corrections = work->stage_corrections;
  real *changes = work->stage_changes;
  real length_before = 0;
  real longest = 0;
  *contraction = 0;
  for (int count = 0; count < most; count++) {
    info->iterations++;
    info->residual = residuals_of_stages(start, unknowns, work->stage_residuals, work);
    if (!isfinite(info->residual)) return SOLVER_MOTION_NOT_FINITE;
    corrections_of(factors, work->stage_residuals, corrections, work);
    apply_step_updates(count, corrections, work);
    velocity_changes(corrections, changes, work);
    const real length = weighted_length(changes, STAGES, work);
    if (!isfinite(length) || !all_finite(corrections, STAGED)) return SOLVER_MOTION_NOT_FINITE;
    for (int stage = 0; stage < STAGES; stage++) {
      for (int i = 0; i < N; i++) {
        unknowns[stage * N + i] += corrections[stage * N + i] * (IS_SHAPE[i] ? to_acceleration : 1);
      }
    }
    /* The first correction allows no prediction. */
    if (count > 0) *contraction = length / length_before;
    const newton_course course = course_of(length, longest, *contraction, allowed, &info->error_left);
    if (course == CONVERGES) return SOLVER_MOTION_DONE;
    if (course == DIVERGES) return SOLVER_MOTION_NOT_SOLVED;
    take_correction(count, corrections, changes, work);
    length_before = length;
    longest = larger(longest, length);
  }
  return SOLVER_MOTION_NOT_SOLVED;
}
