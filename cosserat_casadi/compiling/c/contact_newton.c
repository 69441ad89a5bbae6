/* Newton's method for the equations of one arrangement of contacts; each arrangement has its own size. */

typedef struct {
  contact_status status;
  real residual_norm; /* relative: over one plus the norm of z */
} newton_result;

/* Abscissa of the begin of an element, or of the end of the last one. */
static real end_of_element(const arrangement *at, const real *z, int rod, int number) {
  const rod_elements *elements = at->rods + rod;
  const int place = elements->place_of_end[number];
  return place < 0 ? elements->nominal[number] : z[at->unknowns + at->forces + place];
}

/* Whether the elements of every rod follow each other, none too short. */
static int is_in_order(const arrangement *at, const real *z) {
  for (int rod = 0; rod < RODS; rod++) {
    for (int e = 0; e < at->rods[rod].elements; e++) {
      const real width = end_of_element(at, z, rod, e + 1) - end_of_element(at, z, rod, e);
      if (!(width >= SHORTEST_ELEMENT)) return 0;
    }
  }
  return 1;
}

/* The residual at z; returns its norm, which is infinite where elements do not follow each other. */
static real residual_at(const arrangement *at, const real *z, const real *inputs, real *residual, workspace *work) {
  if (!is_in_order(at, z)) return HUGE_VAL;
  call(at->residual, z, inputs, residual, 0, work);
  return norm_of(residual, at->size);
}

/* Factorises the Jacobian at z in the workspace; zero where it is not finite, or where a pivot is at rounding beside the
   largest entry of its column. */
static int linearise(const arrangement *at, const real *z, const real *inputs, workspace *work) {
  work->jacobian_of = -1;
  work->updates = 0;
  call(at->jacobian, z, inputs, work->jacobian, 0, work);
  if (!all_finite(work->jacobian, at->size * at->size)) return 0;
  for (int j = 0; j < at->size; j++) {
    const real *column = work->jacobian + j * at->size;
    real largest = 0;
    for (int i = 0; i < at->size; i++) largest = larger(largest, fabs(column[i]));
    work->least_pivots[j] = SINGULAR * largest;
  }
  if (!factorise_square(at->size, work->jacobian, work->least_pivots, work->pivots)) return 0;
  work->jacobian_of = (int)(at - ARRANGEMENT);
  return 1;
}

/* Minus the inverse of the present Jacobian times a residual. After steps with one Jacobian the result is corrected by
   C. G. Broyden's updates, applied from the steps alone: C. T. Kelley, Iterative Methods for Linear and Nonlinear
   Equations, SIAM 1995, section 7.3. */
static void quasi_newton_step(const arrangement *at, const real *residual, real *step, workspace *work) {
  const int n = at->size;
  for (int i = 0; i < n; i++) step[i] = -residual[i];
  solve_square(n, work->jacobian, work->pivots, step);
  for (int j = 0; j + 1 < work->updates; j++) {
    const real share = dot(work->steps[j], step, n) / work->squares[j];
    for (int i = 0; i < n; i++) step[i] += work->steps[j + 1][i] * share;
  }
  if (work->updates > 0) {
    const int last = work->updates - 1;
    const real share = 1 - dot(work->steps[last], step, n) / work->squares[last];
    for (int i = 0; i < n; i++) step[i] /= share;
  }
}

/* Length of a change of z: forces count relative to the largest. */
static real change_length(const arrangement *at, const real *z, const real *change) {
  const int behind = at->unknowns + at->forces;
  real largest = 1;
  real sum = dot(change, change, at->unknowns);
  for (int i = at->unknowns; i < behind; i++) largest = larger(largest, fabs(z[i]));
  for (int i = at->unknowns; i < behind; i++) sum += change[i] / largest * (change[i] / largest);
  return sqrt(sum + dot(change + behind, change + behind, at->places));
}

/* Halves the step until the next step with the same Jacobian would be shorter. This test does not depend on the scale
   of the equations, which are small for a short line of contact: P. Deuflhard, Newton Methods for Nonlinear Problems,
   Springer 2004, section 3.3. Returns the accepted length, or zero; updates z, residual and norm, and gives the ratio
   of the next step to this one. */
static real take_step(const arrangement *at, const real *inputs, int max_halvings, real *z, real *norm, real *shortening,
                      workspace *work) {
  const size_t bytes = (size_t)at->size * sizeof *z;
  const real whole = change_length(at, z, work->step);
  real length = 1;
  for (int k = 0; k <= max_halvings; k++) {
    for (int i = 0; i < at->size; i++) work->trial[i] = z[i] + length * work->step[i];
    const real trial_norm = residual_at(at, work->trial, inputs, work->trial_residual, work);
    *shortening = 0;
    if (isfinite(trial_norm) && trial_norm > TOLERANCE * (1 + norm_of(work->trial, at->size))) {
      quasi_newton_step(at, work->trial_residual, work->next_step, work);
      *shortening = change_length(at, z, work->next_step) / whole;
    }
    if (isfinite(trial_norm) && *shortening <= 1 - length / 4) {
      memcpy(z, work->trial, bytes);
      memcpy(work->residual, work->trial_residual, bytes);
      *norm = trial_norm;
      return length;
    }
    length /= 2;
  }
  return 0;
}

/* Remembers a full step for the updates. */
static void append_step(const arrangement *at, workspace *work) {
  memcpy(work->steps[work->updates], work->step, (size_t)at->size * sizeof *work->step);
  work->squares[work->updates] = dot(work->step, work->step, at->size);
  work->updates++;
}

/* Newton's method from z, which it updates; info counts the work, which has a budget. It begins with the present
   Jacobian if that belongs to this arrangement, and keeps it while steps shrink fast. */
static newton_result newton(const arrangement *at, const real *inputs, real *z, int max_iterations, workspace *work,
                            contact_info *info) {
  newton_result result = {.status = CONTACT_MAX_ITERATIONS, .residual_norm = HUGE_VAL};
  real norm = residual_at(at, z, inputs, work->residual, work);
  int reuses = work->jacobian_of == (int)(at - ARRANGEMENT);
  work->updates = 0;
  for (int iteration = 0;; iteration++) {
    const real size = 1 + norm_of(z, at->size);
    result.residual_norm = norm / size;
    if (!isfinite(norm) || !isfinite(size)) {
      result.status = CONTACT_NOT_FINITE;
      return result;
    }
    if (norm <= TOLERANCE * size) {
      result.status = CONTACT_CONVERGED;
      return result;
    }
    if (iteration == MAX_ITERATIONS || info->iterations >= max_iterations) return result;
    info->iterations++;
    if (!reuses) {
      info->jacobians++;
      if (!linearise(at, z, inputs, work)) {
        result.status = CONTACT_SINGULAR;
        return result;
      }
    }
    quasi_newton_step(at, work->residual, work->step, work);
    /* A step of an old Jacobian is not halved: a new Jacobian is worth more. */
    real shortening = 0;
    const real length = take_step(at, inputs, reuses ? 0 : MAX_HALVINGS, z, &norm, &shortening, work);
    if (length == 0 && !reuses) {
      result.status = CONTACT_SINGULAR;
      return result;
    }
    if (length == 1) append_step(at, work);
    reuses = length == 1 && shortening <= REUSE_DECREASE && work->updates < MAX_REUSES;
  }
}
