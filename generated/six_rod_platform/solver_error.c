/* The error of an answer, from modes and intervals that its model lacks. Each missing mode moves by its residual in a
   richer model over its elastic stiffness; the Jacobian of the answer tells how the answer's unknowns follow. A few
   such sweeps converge to Newton's correction with the richer model.

   cosserat_casadi/equilibrium/answer_error.py holds the same in Python, docs/theory.md, section 10, derives it. */

static real larger_or_none(real one, real largest) {
  /* If an argument is not a number, it is the result. */
  return one <= largest ? largest : one;
}

/* The angle between two orientations, rad; the second quaternion may have any length. */
static real angle_between(const real *a, const real *b) {
  const real cosine = a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
  const real x = a[0] * b[1] - a[1] * b[0] - a[2] * b[3] + a[3] * b[2];
  const real y = a[0] * b[2] - a[2] * b[0] - a[3] * b[1] + a[1] * b[3];
  const real z = a[0] * b[3] - a[3] * b[0] - a[1] * b[2] + a[2] * b[1];
  return 2 * (real)atan2(SQUARE_ROOT(x * x + y * y + z * z), ABSOLUTE(cosine));
}

/* The largest change of the watched numbers: displacements over the length, angles in rad, lengthenings over the
   length. */
static real largest_change(const real *before, const real *after) {
  real largest = 0;
  for (int i = 0; i < WATCHED_POSES; i++) {
    const int turned = 3 * WATCHED_POSES + 4 * i;
    real square = 0;
    for (int j = 3 * i; j < 3 * i + 3; j++) square += (after[j] - before[j]) * (after[j] - before[j]);
    largest = larger_or_none(SQUARE_ROOT(square), largest);
    largest = larger_or_none(angle_between(before + turned, after + turned), largest);
  }
  for (int i = WATCHED - WATCHED_CABLES; i < WATCHED; i++) {
    largest = larger_or_none(ABSOLUTE(after[i] - before[i]), largest);
  }
  return largest;
}

/* Least value of an estimate. In float the remainder of Newton's method and rounding often move poses by more than
   missing modes: by up to 2.3 tolerances of the residual in 1200 random answers. */
static real least_error(const real *x) {
#ifdef SOLVER_SINGLE
  real sum = 0;
  for (int i = 0; i < N; i++) sum += IS_SHAPE[i] ? x[i] * x[i] : 0;
  return 3 * TOLERANCE * (1 + SQUARE_ROOT(sum));
#else
  (void)x;
  return ERROR_FLOOR;
#endif
}

static real norm_of_missing(const real *missing) {
  real sum = 0;
  for (int i = 0; i < MISSING; i++) sum += missing[i] * missing[i];
  return SQUARE_ROOT(sum);
}

/* Whether a step of the missing modes is at most half as long as the last one, or rounding. Their stiffness does not
   contain walls: at a wall they bounce, and the watched numbers may settle by chance. */
static int contracts(real before, real step) {
  return step <= ERROR_CONTRACTING * before || step <= 10 * TOLERANCE;
}

/* Computes the balance at the corrections in the workspace. Returns the length of the step of the missing modes by
   it. */
static real balance(const real *x, const real *missing, const real *inputs, workspace *work) {
  richer_balance_at(x, work->known_correction, missing, inputs, work->balance, work);
  return norm_of_missing(work->balance + N);
}

/* Ends the updates of Newton's last Jacobian by a step of infinite length, since no step followed the last one. */
static void end_updates(updated_jacobian *jacobian) {
  if (jacobian->count > 0) jacobian->squares[jacobian->count - 1] = INFINITY;
}

/* Lets the unknowns of the answer follow the missing modes, which leave this residual: by a step with the present
   Jacobian, then by a step from the equations of the answer. Both are needed, since they nearly cancel the motion of a
   tip by the missing modes. Leaves their sum as the correction. Returns the length of the second step over that of the
   first. */
static real follow_missing(const real *x, const loads *at, const real *residual, updated_jacobian *jacobian,
                           workspace *work) {
  real *first = place_of_step(jacobian);
  real *second = work->correction;
  const real first_square = newton_step(jacobian, residual, first, work);
  /* A step from Newton's remainder says nothing about the Jacobian: an update by it may have any size. */
  if (!(norm_of(residual) > 10 * TOLERANCE * (1 + norm_of(x)))) {
    memcpy(work->correction, first, sizeof work->correction);
    return 0;
  }
  append_step(jacobian, first_square);
  for (int i = 0; i < N; i++) work->trial[i] = x[i] + first[i];
  residual_at(work->trial, at, work->trial_residual, work);
  for (int i = 0; i < N; i++) work->trial_residual[i] += residual[i];
  const real second_square = newton_step(jacobian, work->trial_residual, second, work);
  jacobian->count--;
  for (int i = 0; i < N; i++) work->correction[i] += first[i];
  return SQUARE_ROOT(second_square / first_square);
}

/* Change of the watched numbers by the corrections in the workspace, with their balance, and by a step of the unknowns
   of the answer. The step is on the modes of the answer, which differ in second order. */
static real change_with_following(const real *x, const real *inputs, workspace *work) {
  const real *richer = work->balance + 2 * N + MISSING;
  real *after = work->watched_after;
  for (int i = 0; i < N; i++) work->trial[i] = x[i] + work->correction[i];
  watched_at(work->trial, inputs, after, work);
  for (int i = 0; i < WATCHED; i++) after[i] += richer[i] - work->watched[i];
  return largest_change(work->watched, after);
}

/* One sweep of the corrections, by the elastic steps in the workspace. Returns the change of the watched numbers; sets
   next to the length of the next step of the missing modes before the unknowns of the answer follow. */
static real sweep(const real *x, const real *inputs, updated_jacobian *jacobian, real *next, real *shortening,
                  workspace *work) {
  const loads at = full_load(inputs);
  for (int i = 0; i < N; i++) work->known_correction[i] += work->balance[i];
  for (int i = 0; i < MISSING; i++) work->missing[i] += work->balance[N + i];
  *next = balance(x, work->missing, inputs, work);
  *shortening = follow_missing(x, &at, work->balance + N + MISSING, jacobian, work);
  const real change = change_with_following(x, inputs, work);
  for (int i = 0; i < N; i++) work->known_correction[i] += work->correction[i];
  return change;
}

/* Sum r + r^2 + ... of the parts by degrees beyond the richer model, over the part by its two highest degrees: the
   coefficients of each strain fall on as over its highest four. */
static real sum_beyond(const real *x, const workspace *work) {
  real sums[2 * STRAINS + 2] = {0};
  real squares = 0, next = 0;
  for (int i = 0; i < N; i++) {
    const real coefficient = x[i] + work->known_correction[i];
    sums[PAIR_OF_UNKNOWN[i]] += coefficient * coefficient;
  }
  for (int i = 0; i < MISSING; i++) sums[PAIR_OF_MISSING[i]] += work->missing[i] * work->missing[i];
  for (const real *last = sums; last < sums + 2 * STRAINS; last += 2) {
    const real slowest = ERROR_SLOWEST * ERROR_SLOWEST;
    squares += last[0];
    next += last[0] * (last[0] < slowest * last[1] ? last[0] / last[1] : slowest);
  }
  const real ratio = squares > 0 ? SQUARE_ROOT(next / squares) : 0;
  return ratio / (1 - ratio);
}

/* Change of the watched numbers by modes beyond the richer model: the rest of a series. Leaves the missing modes
   without the two highest degrees. */
static real rest_of_series(const real *x, const real *inputs, real change, workspace *work) {
  if (change <= ERROR_FLOOR) return 0;
  const real *richer = work->balance + 2 * N + MISSING;
  const real beyond = sum_beyond(x, work);
  (void)balance(x, work->missing, inputs, work);
  memcpy(work->watched_after, richer, sizeof work->watched_after);
  for (int i = 0; i < MISSING; i++) work->missing[i] *= (real)(PAIR_OF_MISSING[i] % 2);
  (void)balance(x, work->missing, inputs, work);
  return beyond * largest_change(richer, work->watched_after);
}

/* Estimated error of an equilibrium, over the length; 1 if the corrections do not settle. */
static real estimated_error(const real *x, const real *inputs, updated_jacobian *jacobian, workspace *work) {
  const loads at = full_load(inputs);
  const int is_old = jacobian != 0;
  real change_before = INFINITY;
  real step_before = INFINITY;
  int bounced = 0;
  if (is_old) {
    end_updates(jacobian);
  } else {
    jacobian = work->updated_jacobians;
    jacobian->count = 0;
    if (!linearise(x, &at, &jacobian->factors, work)) return 1;
  }
  memset(work->known_correction, 0, sizeof work->known_correction);
  memset(work->missing, 0, sizeof work->missing);
  watched_at(x, inputs, work->watched, work);
  for (int k = 0; k < ERROR_SWEEPS; k++) {
    real next;
    real shortening;
    const real step = balance(x, work->missing, inputs, work);
    if (!contracts(step_before, step)) break;
    const real change = sweep(x, inputs, jacobian, &next, &shortening, work);
    /* An old Jacobian far from that of the answer has no use. */
    if (is_old && !(shortening <= ERROR_FOLLOWED)) return estimated_error(x, inputs, 0, work);
    if (!isfinite(change)) break;
    /* If the first step bounces, the next one may be short by chance: neither is believed. */
    if (k == 0) bounced = !contracts(step, next);
    const int believed = !bounced || k > 1;
    const int rests = step <= ERROR_SETTLED * norm_of_missing(work->missing) || step <= 10 * TOLERANCE;
    const int settled = rests && ABSOLUTE(change - change_before) <= ERROR_SETTLED * change;
    /* A first sweep that leaves the answer within its tolerance is enough. */
    if (believed && (settled || change <= ERROR_ENOUGH)) {
      for (int e = 0; e < TURNED.elements; e++) {
        if (hides_waves(&TURNED, e, 1, x, work->missing)) return 1;
      }
      const real rest = settled ? rest_of_series(x, inputs, change, work) : 0;
      return (settled ? ERROR_SAFETY : ERROR_FIRST_LOOK) * (change + rest) + least_error(x);
    }
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
  *error_estimate = estimated_error(x, inputs, 0, work);
  return SOLVER_CONVERGED;
}
