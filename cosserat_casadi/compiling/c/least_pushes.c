/* Forces of one-sided constraints that only push, and let none of the constraints be passed. Exported steps and
   simulated motions both include it. */

/* A constraint depends on active ones if they leave less than this share of its compliance. A rate that the forces
   close to less than this share of their contribution counts as rounding. */
static const real DEPENDENT = (real)1e-9;

/* Fall of an active force by a unit of a dependent force, in their scales, that counts as rounding. */
static const real FALLS = (real)1e-4;

/* Solves with the rows and columns of W of some constraints, in place. */
static int solve_active(const real *w, int count, const int *active, int active_count, real *values, workspace *work) {
  real *a = work->small_matrix;
  for (int j = 0; j < active_count; j++) {
    for (int i = 0; i < active_count; i++) a[j * active_count + i] = w[active[j] * count + active[i]];
  }
  if (!factorise_square(active_count, a, 0, work->small_pivots)) return 0;
  solve_square(active_count, a, work->small_pivots, values);
  return all_finite(values, active_count);
}

static void leave_active(int *active, int *active_count, int which) {
  for (int i = which; i + 1 < *active_count; i++) active[i] = active[i + 1];
  *active_count -= 1;
}

/* Forces f >= 0 of constraints that open by q + W f >= 0, one of both zero; W, column after column, is symmetric and
   positive semidefinite but for units of the forces. Zero where rounding keeps them from settling.

   A constraint that closes is made active, the fastest first, and leaves again where it would pull: the method of least
   squares with non-negative unknowns, which does not run in circles (C. L. Lawson, R. J. Hanson, Solving Least Squares
   Problems, SIAM 1995, chapter 23). One that depends on the active ones and closes all the same takes the place of one of
   them: its force grows, at no change of the opening rates, until the first active force is zero. Where it closes to
   rounding only, or where no active force falls, so that no forces stop it, it stays inactive. */
static int least_pushes(const real *compliance, const real *rates, int count, real tolerance, real *forces,
                        workspace *work) {
  real *w = work->scaled_compliance;
  real *scale = work->scales;
  real *values = work->small_values;
  int *active = work->active;
  int *passed_over = work->passed_over;
  int active_count = 0;
  real largest = 0;
  for (int k = 0; k < count; k++) {
    scale[k] = SQUARE_ROOT(larger(compliance[k * count + k], 0));
    largest = larger(largest, scale[k]);
  }
  for (int k = 0; k < count; k++) {
    passed_over[k] = !(scale[k] > DEPENDENT * largest);
    scale[k] = passed_over[k] ? 0 : 1 / scale[k];
    forces[k] = 0;
  }
  for (int j = 0; j < count; j++) {
    for (int i = 0; i < count; i++) w[j * count + i] = scale[i] * compliance[j * count + i] * scale[j];
  }
  for (int turn = 0; turn < 10 * count; turn++) {
    int fastest = -1;
    real least = 0, summed = 0;
    for (int k = 0; k < count; k++) {
      int is_active = passed_over[k];
      for (int i = 0; i < active_count; i++) is_active |= active[i] == k;
      if (is_active) continue;
      real opening = scale[k] * rates[k];
      for (int i = 0; i < count; i++) opening += w[i * count + k] * forces[i];
      if (opening < -tolerance * scale[k] && opening < least) {
        least = opening;
        fastest = k;
      }
    }
    if (fastest < 0) {
      for (int k = 0; k < count; k++) forces[k] *= scale[k];
      return 1;
    }
    /* Change of the active forces by a unit of its force at constant gaps. */
    for (int i = 0; i < active_count; i++) values[i] = -w[fastest * count + active[i]];
    if (!solve_active(w, count, active, active_count, values, work)) return 0;
    real left = w[fastest * count + fastest];
    for (int i = 0; i < active_count; i++) left += w[active[i] * count + fastest] * values[i];
    if (left < DEPENDENT) {
      int falling = -1;
      real lasts = 0;
      summed = ABSOLUTE(scale[fastest] * rates[fastest]);
      for (int i = 0; i < count; i++) summed += ABSOLUTE(w[i * count + fastest]) * forces[i];
      for (int i = 0; i < active_count; i++) {
        if (!(values[i] < -FALLS)) continue;
        const real own = forces[active[i]] / -values[i];
        if (falling < 0 || own < lasts) {
          falling = i;
          lasts = own;
        }
      }
      if (least >= -DEPENDENT * summed || falling < 0) {
        passed_over[fastest] = 1;
        continue;
      }
      for (int i = 0; i < active_count; i++) forces[active[i]] += lasts * values[i];
      forces[fastest] = lasts;
      forces[active[falling]] = 0;
      leave_active(active, &active_count, falling);
    }
    active[active_count++] = fastest;
    while (active_count > 0) {
      int first = -1;
      real share = 1;
      for (int i = 0; i < active_count; i++) values[i] = -scale[active[i]] * rates[active[i]];
      if (!solve_active(w, count, active, active_count, values, work)) return 0;
      for (int i = 0; i < active_count; i++) {
        const real present = forces[active[i]];
        if (values[i] > 0) continue;
        const real own = present > values[i] ? present / (present - values[i]) : 0;
        if (first < 0 || own < share) {
          first = i;
          share = own;
        }
      }
      if (first < 0) {
        for (int i = 0; i < active_count; i++) forces[active[i]] = values[i];
        break;
      }
      for (int i = 0; i < active_count; i++) forces[active[i]] += share * (values[i] - forces[active[i]]);
      forces[active[first]] = 0;
      leave_active(active, &active_count, first);
    }
  }
  return 0;
}
