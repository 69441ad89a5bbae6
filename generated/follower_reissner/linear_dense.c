/* Linear algebra of a scene with one dense Jacobian. Matrices are stored column after column.

   Uses of the equations: residual_at, jacobian_at, rate_at. Gives: linearise, back_substitute, input_jacobian_at,
   dense_jacobian_at. */

static real larger_of(real one, real other) { return one > other ? one : other; }

/* Size of the largest entry. Four independent candidates run in parallel. */
static real largest_entry(const real *a, int count) {
  real largest[4] = {0, 0, 0, 0};
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    largest[0] = larger_of(ABSOLUTE(a[i]), largest[0]);
    largest[1] = larger_of(ABSOLUTE(a[i + 1]), largest[1]);
    largest[2] = larger_of(ABSOLUTE(a[i + 2]), largest[2]);
    largest[3] = larger_of(ABSOLUTE(a[i + 3]), largest[3]);
  }
  for (; i < count; i++) largest[0] = larger_of(ABSOLUTE(a[i]), largest[0]);
  return larger_of(larger_of(largest[0], largest[1]), larger_of(largest[2], largest[3]));
}

static void swap_rows(real *a, int k, int m) {
  for (int j = 0; j < N; j++) {
    const real kept = a[j * N + k];
    a[j * N + k] = a[j * N + m];
    a[j * N + m] = kept;
  }
}

/* Row of the largest entry on or below the diagonal of column k, the first of equal entries. */
static int pivot_row(const real *column, int k) {
  const real largest = largest_entry(column + k, N - k);
  int row = k;
  while (row < N - 1 && ABSOLUTE(column[row]) != largest) row++;
  return row;
}

/* Gaussian elimination with partial pivoting, in place, column after column: G. H. Golub, C. F. Van Loan, Matrix
   Computations, 4th edition, algorithm 3.4.1. The diagonal holds inverse pivots, zero for one at rounding of its column
   (tension makes others large), since symmetry may let a rod turn without energy. Returns whether there was none. */
static int factorise(real *a, int *pivots) {
  const real tiny = SINGULAR * largest_entry(a, N * N);
  int regular = 1;
  for (int k = 0; k < N; k++) {
    real *column = a + k * N;
    pivots[k] = pivot_row(column, k);
    if (pivots[k] != k) swap_rows(a, k, pivots[k]);
    if (ABSOLUTE(column[k]) <= tiny && ABSOLUTE(column[k]) <= SINGULAR * larger_of(1, largest_entry(column, N))) {
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

/* Subtracts from four neighbouring rows of a right-hand side their factors times the known unknowns, first to last by a
   step of 1 or -1. */
static void subtract_known(const real *rows, const real *known, int from, int to, int step, real *left) {
  real a = left[0];
  real b = left[1];
  real c = left[2];
  real d = left[3];
  for (int k = from; k != to; k += step) {
    const real *factors = rows + k * N;
    const real value = known[k];
    a -= factors[0] * value;
    b -= factors[1] * value;
    c -= factors[2] * value;
    d -= factors[3] * value;
  }
  left[0] = a;
  left[1] = b;
  left[2] = c;
  left[3] = d;
}

enum { ROWS_BEFORE_FOURS = N % 4 };

/* Substitutes forward with the unit lower triangle. */
static void solve_lower_triangle(const real *a, real *b) {
  for (int i = 0; i < ROWS_BEFORE_FOURS; i++) {
    for (int k = 0; k < i; k++) b[i] -= a[k * N + i] * b[k];
  }
  for (int i = ROWS_BEFORE_FOURS; i < N; i += 4) {
    const real *triangle = a + i * N + i;
    real *left = b + i;
    subtract_known(a + i, b, 0, i, 1, left);
    const real first = left[0];
    const real second = left[1] - triangle[1] * first;
    const real third = left[2] - triangle[2] * first - triangle[N + 2] * second;
    left[1] = second;
    left[2] = third;
    left[3] = left[3] - triangle[3] * first - triangle[N + 3] * second - triangle[2 * N + 3] * third;
  }
}

/* Substitutes backward with the upper triangle, whose diagonal holds inverse pivots. */
static void solve_upper_triangle(const real *a, real *b) {
  for (int i = N - 4; i >= ROWS_BEFORE_FOURS; i -= 4) {
    const real *triangle = a + i * N + i;
    real *left = b + i;
    subtract_known(a + i, b, N - 1, i + 3, -1, left);
    const real fourth = left[3] * triangle[3 * N + 3];
    const real third = (left[2] - triangle[3 * N + 2] * fourth) * triangle[2 * N + 2];
    const real second = (left[1] - triangle[3 * N + 1] * fourth - triangle[2 * N + 1] * third) * triangle[N + 1];
    left[0] = (left[0] - triangle[3 * N] * fourth - triangle[2 * N] * third - triangle[N] * second) * triangle[0];
    left[1] = second;
    left[2] = third;
    left[3] = fourth;
  }
  for (int i = ROWS_BEFORE_FOURS - 1; i >= 0; i--) {
    for (int k = N - 1; k > i; k--) b[i] -= a[k * N + i] * b[k];
    b[i] *= a[i * N + i];
  }
}

/* Solves with the factors, in place; an unknown without a pivot is left at zero. */
static void back_substitute(const jacobian_factors *jacobian, real *b, workspace *work) {
  (void)work;
  permute(jacobian->pivots, b);
  solve_lower_triangle(jacobian->factors, b);
  solve_upper_triangle(jacobian->factors, b);
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
