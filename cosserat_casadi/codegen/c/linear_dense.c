/* Linear algebra of a scene with one dense Jacobian. Matrices are stored column after column.

   Uses of the equations: residual_at, jacobian_at, rate_at. Gives: linearise, back_substitute, input_jacobian_at,
   dense_jacobian_at. */

static real largest_entry(const real *a, int count) {
  real largest = 0;
  for (int i = 0; i < count; i++) {
    if (ABSOLUTE(a[i]) > largest) largest = ABSOLUTE(a[i]);
  }
  return largest;
}

static void swap_rows(real *a, int k, int m) {
  for (int j = 0; j < N; j++) {
    const real kept = a[j * N + k];
    a[j * N + k] = a[j * N + m];
    a[j * N + m] = kept;
  }
}

/* Row of the largest entry on or below the diagonal of column k. */
static int pivot_row(const real *column, int k) {
  int best = k;
  for (int i = k + 1; i < N; i++) {
    if (ABSOLUTE(column[i]) > ABSOLUTE(column[best])) best = i;
  }
  return best;
}

/* Gaussian elimination with partial pivoting, in place, column after column: G. H. Golub, C. F. Van Loan, Matrix
   Computations, 4th edition, algorithm 3.4.1. The diagonal holds inverse pivots, zero for one at rounding, since symmetry
   may let a rod turn without energy. Returns whether there was none. */
static int factorise(real *a, int *pivots) {
  const real tiny = SINGULAR * largest_entry(a, N * N);
  int regular = 1;
  for (int k = 0; k < N; k++) {
    real *column = a + k * N;
    pivots[k] = pivot_row(column, k);
    if (pivots[k] != k) swap_rows(a, k, pivots[k]);
    if (ABSOLUTE(column[k]) <= tiny) {
      for (int i = k; i < N; i++) column[i] = 0;
      regular = 0;
      continue;
    }
    column[k] = 1 / column[k];
    for (int i = k + 1; i < N; i++) column[i] *= column[k];
    for (int j = k + 1; j < N; j++) {
      real *target = a + j * N;
      const real factor = target[k];
      if (factor == 0) continue;
      for (int i = k + 1; i < N; i++) target[i] -= column[i] * factor;
    }
  }
  return regular;
}

/* Brings a right-hand side into the order of the pivots. */
static void permute(const int *pivots, real *b) {
  for (int k = 0; k < N; k++) {
    const real kept = b[pivots[k]];
    b[pivots[k]] = b[k];
    b[k] = kept;
  }
}

/* Solves with the factors, in place; an unknown without a pivot is left at zero. */
static void back_substitute(const jacobian_factors *jacobian, real *b, workspace *work) {
  const real *a = jacobian->factors;
  (void)work;
  permute(jacobian->pivots, b);
  for (int k = 0; k < N; k++) {
    for (int i = k + 1; i < N; i++) b[i] -= a[k * N + i] * b[k];
  }
  for (int k = N - 1; k >= 0; k--) {
    b[k] *= a[k * N + k];
    for (int i = 0; i < k; i++) b[i] -= a[k * N + i] * b[k];
  }
}

/* Factorised Jacobian at x; zero where it is not finite. */
static int linearise(const real *x, const loads *at, jacobian_factors *jacobian, workspace *work) {
  jacobian_at(x, at, jacobian->factors, work);
  if (!all_finite(jacobian->factors, N * N)) return 0;
  jacobian->regular = factorise(jacobian->factors, jacobian->pivots);
  return 1;
}

static void dense_jacobian_at(const real *x, const loads *at, real *jacobian, workspace *work) {
  jacobian_at(x, at, jacobian, work);
}

/* d residual / d inputs: the rate of the residual while one input after the other grows at unit speed. */
static void input_jacobian_at(const real *x, const loads *at, real *d_residual_d_inputs, workspace *work) {
  real *speed = work->inputs_rate;
  for (int j = 0; j < INPUTS; j++) speed[j] = 0;
  for (int j = 0; j < INPUTS; j++) {
    speed[j] = 1;
    rate_at(x, at, speed, 0, d_residual_d_inputs + j * N, work);
    speed[j] = 0;
  }
}
