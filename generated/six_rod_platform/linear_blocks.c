/* Linear algebra of an assembly: the multifrontal method with one front a rod (I. S. Duff, J. K. Reid, ACM Trans. Math.
   Software 9, 1983). Each rod is eliminated on its own with the rows and columns of the interface that it touches, the
   frames that move; what is left of the interface is eliminated last. Matrices are stored column after column.

   Uses of the scene: the tables RESIDUAL_PARTS, JACOBIAN_PARTS, INPUT_PARTS, FRONTS, FRONT_INDICES, DENSE_INDICES,
   INTERFACE_MEMBERS. Gives: residual_at, linearise, back_substitute, input_jacobian_at, dense_jacobian_at. */

static void evaluate(const part *parts, int count, const real *x, const loads *at, real *results, workspace *work) {
  for (int k = 0; k < count; k++) {
    const part *own = parts + k;
    for (int i = 0; i < own->unknown_count; i++) work->part_unknowns[i] = x[own->unknowns[i]];
    for (int i = 0; i < own->input_count; i++) work->part_inputs[i] = at->inputs[own->inputs[i]];
    own->kernel(work->part_unknowns, work->part_inputs, &at->load_factor, own->constants, work->part_entries, work);
    for (int i = 0; i < own->entry_count; i++) results[own->entries[i]] = work->part_entries[i];
  }
}

static void residual_at(const real *x, const loads *at, real *residual, workspace *work) {
  evaluate(RESIDUAL_PARTS, RESIDUAL_PART_COUNT, x, at, residual, work);
}

static void jacobian_entries_at(const real *x, const loads *at, real *entries, workspace *work) {
  evaluate(JACOBIAN_PARTS, JACOBIAN_PART_COUNT, x, at, entries, work);
}

/* Columns of a matrix times factors, subtracted from some rows of b; four at a time keep b in registers. */
static void subtract(const real *a, int order, const real *factors, int count, int from, int to, real *b) {
  int k;
  for (k = 0; k + 4 <= count; k += 4) {
    const real *column_1 = a + k * order;
    const real *column_2 = column_1 + order;
    const real *column_3 = column_2 + order;
    const real *column_4 = column_3 + order;
    const real s = factors[k];
    const real t = factors[k + 1];
    const real u = factors[k + 2];
    const real v = factors[k + 3];
    if (s == 0 && t == 0 && u == 0 && v == 0) continue;
    for (int i = from; i < to; i++) {
      b[i] -= column_1[i] * s + column_2[i] * t + (column_3[i] * u + column_4[i] * v);
    }
  }
  for (; k < count; k++) {
    const real *column = a + k * order;
    const real factor = factors[k];
    if (factor == 0) continue;
    for (int i = from; i < to; i++) b[i] -= column[i] * factor;
  }
}

/* Forward substitution of b with the first columns, in panels of four. */
static void forward(const real *a, int order, int count, const int *pivots, real *b) {
  for (int k = 0; k < count; k++) {
    const real kept = b[pivots[k]];
    b[pivots[k]] = b[k];
    b[k] = kept;
  }
  for (int k = 0; k < count; k += 4) {
    const int next = k + 4 < count ? k + 4 : count;
    for (int m = k; m < next; m++) {
      for (int i = m + 1; i < next; i++) b[i] -= a[m * order + i] * b[m];
    }
    subtract(a + k * order, order, b + k, next - k, next, order, b);
  }
}

/* Backward substitution; the unknowns of the other columns are known. An unknown without a pivot stays zero. */
static void backward(const real *a, int order, int count, real *b) {
  subtract(a + count * order, order, b + count, order - count, 0, count, b);
  for (int k = count; k > 0; k -= 4) {
    const int next = k > 4 ? k - 4 : 0;
    for (int m = k - 1; m >= next; m--) {
      b[m] *= a[m * order + m];
      for (int i = next; i < m; i++) b[i] -= a[m * order + i] * b[m];
    }
    subtract(a + next * order, order, b + next, k - next, 0, next, b);
  }
}

/* Row of the largest entry of a column among the rows k to count. */
static int pivot_row(const real *column, int k, int count) {
  int best = k;
  for (int i = k + 1; i < count; i++) {
    if (ABSOLUTE(column[i]) > ABSOLUTE(column[best])) best = i;
  }
  return best;
}

/* Whether a pivot is at rounding of its column: tension makes other columns large. */
static int vanishes(const real *column, int k, int order, real tiny) {
  real largest = 1;
  if (ABSOLUTE(column[k]) > tiny) return 0;
  for (int i = 0; i < order; i++) {
    if (ABSOLUTE(column[i]) > largest) largest = ABSOLUTE(column[i]);
  }
  return ABSOLUTE(column[k]) <= SINGULAR * largest;
}

/* Gaussian elimination of the first columns, in place and left-looking, with partial pivoting among as many rows: G. H.
   Golub, C. F. Van Loan, Matrix Computations, 4th edition, section 3.4. The diagonal holds inverse pivots, zero for one
   at rounding. Returns whether there was none. */
static int eliminate(real *a, int order, int count, real tiny, int *pivots) {
  int regular = 1;
  for (int k = 0; k < order; k++) {
    real *column = a + k * order;
    forward(a, order, k < count ? k : count, pivots, column);
    if (k >= count) continue;
    const int best = pivot_row(column, k, count);
    pivots[k] = best;
    for (int j = 0; best != k && j <= k; j++) {
      const real kept = a[j * order + k];
      a[j * order + k] = a[j * order + best];
      a[j * order + best] = kept;
    }
    const int is_neutral = vanishes(column, k, order, tiny);
    const real inverse = is_neutral ? 0 : 1 / column[k];
    if (is_neutral) regular = 0;
    column[k] = inverse;
    for (int i = k + 1; i < order; i++) column[i] *= inverse;
  }
  return regular;
}

/* Eliminates rod after rod, then the Schur complement of the interface. Returns zero if a pivot is at rounding. */
static int eliminate_fronts(real *a, real tiny, int *pivots) {
  real *interface = a + INTERFACE_START;
  for (int k = 0; k < FRONT_COUNT; k++) {
    const front *rod = FRONTS + k;
    const int order = rod->member_count + rod->interface_count;
    real *own = a + rod->start;
    if (!eliminate(own, order, rod->member_count, tiny, pivots)) return 0;
    pivots += rod->member_count;
    /* The Schur complement of the rod. */
    for (int j = 0; j < rod->interface_count; j++) {
      const real *column = own + (rod->member_count + j) * order + rod->member_count;
      real *target = interface + rod->interface[j] * INTERFACE;
      for (int i = 0; i < rod->interface_count; i++) target[rod->interface[i]] += column[i];
    }
  }
  return eliminate(interface, INTERFACE, INTERFACE, tiny, pivots);
}

/* Gathers the right-hand side of one rod; returns whether an entry differs from zero. */
static int gather(const front *rod, const real *b, real *own) {
  int any = 0;
  for (int i = 0; i < rod->member_count; i++) {
    own[i] = b[rod->members[i]];
    any |= own[i] != 0;
  }
  for (int i = 0; i < rod->interface_count; i++) own[rod->member_count + i] = 0;
  return any;
}

static void substitute_fronts(const real *a, const int *pivots, real *b, workspace *work) {
  real *interface = work->interface_values;
  for (int i = 0; i < INTERFACE; i++) interface[i] = b[INTERFACE_MEMBERS[i]];
  for (int k = 0; k < FRONT_COUNT; k++) {
    const front *rod = FRONTS + k;
    const int order = rod->member_count + rod->interface_count;
    real *own = work->front_values[k];
    if (gather(rod, b, own)) forward(a + rod->start, order, rod->member_count, pivots, own);
    for (int i = 0; i < rod->interface_count; i++) interface[rod->interface[i]] += own[rod->member_count + i];
    pivots += rod->member_count;
  }
  forward(a + INTERFACE_START, INTERFACE, INTERFACE, pivots, interface);
  backward(a + INTERFACE_START, INTERFACE, INTERFACE, interface);
  for (int i = 0; i < INTERFACE; i++) b[INTERFACE_MEMBERS[i]] = interface[i];
  for (int k = 0; k < FRONT_COUNT; k++) {
    const front *rod = FRONTS + k;
    const int order = rod->member_count + rod->interface_count;
    real *own = work->front_values[k];
    for (int i = 0; i < rod->interface_count; i++) own[rod->member_count + i] = interface[rod->interface[i]];
    backward(a + rod->start, order, rod->member_count, own);
    for (int i = 0; i < rod->member_count; i++) b[rod->members[i]] = own[i];
  }
}

/* Solves with the factors, in place; an unknown without a pivot is left at zero. */
static void back_substitute(const jacobian_factors *jacobian, real *b, workspace *work) {
  if (jacobian->dense) {
    forward(jacobian->factors, N, N, jacobian->pivots, b);
    backward(jacobian->factors, N, N, b);
  } else {
    substitute_fronts(jacobian->factors, jacobian->pivots, b, work);
  }
}

/* Factorised Jacobian at x; zero where it is not finite. A rod without a pivot may have one in the interface: then the
   matrix is eliminated as a whole. */
static int linearise(const real *x, const loads *at, jacobian_factors *jacobian, workspace *work) {
  const real *entries = work->entries;
  real largest = 0;
  jacobian_entries_at(x, at, work->entries, work);
  if (!all_finite(entries, ENTRIES)) return 0;
  for (int i = 0; i < ENTRIES; i++) {
    if (ABSOLUTE(entries[i]) > largest) largest = ABSOLUTE(entries[i]);
  }
  const real tiny = SINGULAR * largest;
  memset(jacobian->factors, 0, FRONTS_SIZE * sizeof *jacobian->factors);
  for (int i = 0; i < ENTRIES; i++) jacobian->factors[FRONT_INDICES[i]] = entries[i];
  jacobian->regular = eliminate_fronts(jacobian->factors, tiny, jacobian->pivots);
  jacobian->dense = !jacobian->regular;
  if (jacobian->dense) {
    memset(jacobian->factors, 0, N * N * sizeof *jacobian->factors);
    for (int i = 0; i < ENTRIES; i++) jacobian->factors[DENSE_INDICES[i]] = entries[i];
    jacobian->regular = eliminate(jacobian->factors, N, N, tiny, jacobian->pivots);
  }
  return 1;
}

static void dense_jacobian_at(const real *x, const loads *at, real *jacobian, workspace *work) {
  jacobian_entries_at(x, at, work->entries, work);
  memset(jacobian, 0, N * N * sizeof *jacobian);
  for (int i = 0; i < ENTRIES; i++) jacobian[DENSE_INDICES[i]] = work->entries[i];
}

/* d residual / d inputs, N x INPUTS. */
static void input_jacobian_at(const real *x, const loads *at, real *d_residual_d_inputs, workspace *work) {
  for (int i = 0; i < N * INPUTS; i++) d_residual_d_inputs[i] = 0;
  evaluate(INPUT_PARTS, INPUT_PART_COUNT, x, at, d_residual_d_inputs, work);
}
