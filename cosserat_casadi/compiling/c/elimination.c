/* Gaussian elimination of the linear systems of a step, front after front: a rod with the part of the interface that it
   touches, then the interface (I. S. Duff, J. K. Reid, ACM Trans. Math. Software 9, 1983). A scene with one front has no
   interface.

   A matrix is complex, of size N, or real, with an unknown for each stage. A column of complex numbers is two planes: its
   real parts, then its imaginary ones. Matrices are stored column after column. */

/* Kind of a matrix: planes of a number (2 if complex), stages of each unknown, and the pivot that counts as zero beside
   entries of one. */
typedef struct {
  int planes;
  int copies;
  real tiny;
} matrix_kind;

static matrix_kind complex_matrix(void) {
  const matrix_kind kind = {2, 1, SINGULAR_STEP};
  return kind;
}

static matrix_kind matrix_of_stages(void) {
  const matrix_kind kind = {1, STAGES, SINGULAR_STEP};
  return kind;
}

/* A real matrix; its pivots are too small if there is almost no mass. */
static matrix_kind matrix_of_masses(void) {
  const matrix_kind kind = {1, 1, MASSLESS};
  return kind;
}

/* Vectors have as many lanes as a matrix has planes, which lie one after the other, or FOUR: those of four right-hand sides
   of a real matrix, which lie side by side. */

/* Subtracts the columns first to last, times the entries of b there, from rows of b. Some rows stay in registers. */
static void subtract_real(const real *a, int order, int first, int last, int from, int to, real *b) {
  int i = from;
  for (; i + 4 <= to; i += 4) {
    real s = b[i], t = b[i + 1], u = b[i + 2], v = b[i + 3];
    for (int k = first; k < last; k++) {
      const real *column = a + k * order + i;
      const real factor = b[k];
      s -= column[0] * factor;
      t -= column[1] * factor;
      u -= column[2] * factor;
      v -= column[3] * factor;
    }
    b[i] = s;
    b[i + 1] = t;
    b[i + 2] = u;
    b[i + 3] = v;
  }
  for (; i < to; i++) {
    real s = b[i];
    for (int k = first; k < last; k++) s -= a[k * order + i] * b[k];
    b[i] = s;
  }
}

static void subtract_complex(const real *a, int order, int first, int last, int from, int to, real *b) {
  real *b_imaginary = b + order;
  int i = from;
  for (; i + 2 <= to; i += 2) {
    real s = b[i], t = b[i + 1], s_imaginary = b_imaginary[i], t_imaginary = b_imaginary[i + 1];
    for (int k = first; k < last; k++) {
      const real *column = a + k * 2 * order + i;
      const real *imaginary = column + order;
      const real factor = b[k];
      const real factor_imaginary = b_imaginary[k];
      s -= column[0] * factor - imaginary[0] * factor_imaginary;
      t -= column[1] * factor - imaginary[1] * factor_imaginary;
      s_imaginary -= column[0] * factor_imaginary + imaginary[0] * factor;
      t_imaginary -= column[1] * factor_imaginary + imaginary[1] * factor;
    }
    b[i] = s;
    b[i + 1] = t;
    b_imaginary[i] = s_imaginary;
    b_imaginary[i + 1] = t_imaginary;
  }
  for (; i < to; i++) {
    for (int k = first; k < last; k++) {
      const real *column = a + k * 2 * order + i;
      const real product = column[0] * b[k] - column[order] * b_imaginary[k];
      b_imaginary[i] -= column[0] * b_imaginary[k] + column[order] * b[k];
      b[i] -= product;
    }
  }
}

static void subtract_four(const real *a, int order, int first, int last, int from, int to, real *b) {
  int i = from;
  for (; i + 2 <= to; i += 2) {
    real *row = b + FOUR * i;
    real s_1 = row[0], s_2 = row[1], s_3 = row[2], s_4 = row[3];
    real t_1 = row[4], t_2 = row[5], t_3 = row[6], t_4 = row[7];
    for (int k = first; k < last; k++) {
      const real *factors = b + FOUR * k;
      const real s = a[k * order + i];
      const real t = a[k * order + i + 1];
      s_1 -= s * factors[0];
      s_2 -= s * factors[1];
      s_3 -= s * factors[2];
      s_4 -= s * factors[3];
      t_1 -= t * factors[0];
      t_2 -= t * factors[1];
      t_3 -= t * factors[2];
      t_4 -= t * factors[3];
    }
    row[0] = s_1;
    row[1] = s_2;
    row[2] = s_3;
    row[3] = s_4;
    row[4] = t_1;
    row[5] = t_2;
    row[6] = t_3;
    row[7] = t_4;
  }
  for (; i < to; i++) {
    for (int k = first; k < last; k++) {
      for (int lane = 0; lane < FOUR; lane++) b[FOUR * i + lane] -= a[k * order + i] * b[FOUR * k + lane];
    }
  }
}

static void subtract_columns(int lanes, const real *a, int order, int first, int last, int from, int to, real *b) {
  if (lanes == 1) {
    subtract_real(a, order, first, last, from, to, b);
  } else if (lanes == FOUR) {
    subtract_four(a, order, first, last, from, to, b);
  } else {
    subtract_complex(a, order, first, last, from, to, b);
  }
}

/* Distance of neighbouring entries of a vector, and of the lanes of one. */
static int entry_stride(int lanes) { return lanes == FOUR ? FOUR : 1; }

static int lane_stride(int lanes, int order) { return lanes == FOUR ? 1 : order; }

/* One entry of a vector times a number. */
static void scale(int lanes, int order, int i, real factor, real factor_imaginary, real *b) {
  if (lanes == 2) {
    const real whole = b[i] * factor - b[order + i] * factor_imaginary;
    b[order + i] = b[i] * factor_imaginary + b[order + i] * factor;
    b[i] = whole;
  } else {
    for (int lane = 0; lane < lanes; lane++) b[lanes * i + lane] *= factor;
  }
}

static void swap_entries(int lanes, int order, int i, int k, real *b) {
  if (i == k) return;
  for (int lane = 0; lane < lanes; lane++) {
    real *own = b + lane * lane_stride(lanes, order);
    const int stride = entry_stride(lanes);
    const real kept = own[i * stride];
    own[i * stride] = own[k * stride];
    own[k * stride] = kept;
  }
}

/* Forward substitution of b with the first columns, in panels of four. */
static void substitute_forward(int lanes, const real *a, int order, int count, const int *pivots, real *b) {
  for (int k = 0; k < count; k++) swap_entries(lanes, order, k, pivots[k], b);
  for (int k = 0; k < count; k += 4) {
    const int next = k + 4 < count ? k + 4 : count;
    for (int m = k; m < next; m++) subtract_columns(lanes, a, order, m, m + 1, m + 1, next, b);
    subtract_columns(lanes, a, order, k, next, next, order, b);
  }
}

/* Backward substitution; the unknowns of the other columns are known. */
static void substitute_backward(int lanes, const real *a, int order, int count, real *b) {
  const int planes = lanes == 2 ? 2 : 1;
  subtract_columns(lanes, a, order, count, order, 0, count, b);
  for (int k = count; k > 0; k -= 4) {
    const int next = k > 4 ? k - 4 : 0;
    for (int m = k - 1; m >= next; m--) {
      const real *pivot = a + m * planes * order + m;
      scale(lanes, order, m, pivot[0], planes == 1 ? 0 : pivot[order], b);
      subtract_columns(lanes, a, order, m, m + 1, next, m, b);
    }
    subtract_columns(lanes, a, order, next, k, 0, next, b);
  }
}

/* Size of an entry; for a complex one the sum of the sizes of its parts. */
static real size_of(int planes, int order, const real *entry) {
  return planes == 1 ? ABSOLUTE(entry[0]) : ABSOLUTE(entry[0]) + ABSOLUTE(entry[order]);
}

/* Elimination of the first columns, in place and left-looking, with partial pivoting among as many rows: G. H. Golub,
   C. F. Van Loan, Matrix Computations, 4th edition, section 3.4. The diagonal holds inverse pivots. Zero where a pivot is
   too small. */
static int eliminate_columns(int planes, real tiny, real *a, int order, int count, int *pivots) {
  for (int k = 0; k < order; k++) {
    real *column = a + k * planes * order;
    substitute_forward(planes, a, order, k < count ? k : count, pivots, column);
    if (k >= count) continue;
    int best = k;
    for (int i = k + 1; i < count; i++) {
      if (size_of(planes, order, column + i) > size_of(planes, order, column + best)) best = i;
    }
    pivots[k] = best;
    for (int j = 0; best != k && j <= k; j++) swap_entries(planes, order, k, best, a + j * planes * order);
    /* Not "size <= bound": a pivot that is not a number must end the elimination too. */
    if (!(size_of(planes, order, column + k) > tiny)) return 0;
    const real whole = column[k];
    const real imaginary = planes == 1 ? 0 : column[order + k];
    const real square = whole * whole + imaginary * imaginary;
    column[k] = whole / square;
    if (planes == 2) column[order + k] = -imaginary / square;
    for (int i = k + 1; i < order; i++) scale(planes, order, i, whole / square, -imaginary / square, column);
  }
  return 1;
}

/* Place of an unknown of a front in one of its copies; members stand before the interface. */
static int place(const stage_front *own, matrix_kind kind, int local, int copy) {
  if (local < own->member_count) return copy * own->member_count + local;
  return kind.copies * own->member_count + copy * own->interface_count + local - own->member_count;
}

static int order_of(const stage_front *own, matrix_kind kind) {
  return kind.copies * (own->member_count + own->interface_count);
}

/* Scales rows and columns so that the largest entry of each is one. Zero where a row or a column is empty. */
static int scales_of(matrix_kind kind, const real *values, real *rows, real *columns) {
  const int count = kind.copies * N;
  for (int pass = 0; pass < 2; pass++) {
    real *scaled = pass == 0 ? rows : columns;
    for (int i = 0; i < count; i++) scaled[i] = 0;
    for (int s = 0; s < kind.copies; s++) {
      for (int t = 0; t < kind.copies; t++) {
        const real *block = values + (s * kind.copies + t) * kind.planes * STAGE_ENTRIES;
        for (int k = 0; k < STAGE_ENTRIES; k++) {
          const int row = s * N + ENTRY_ROWS[k];
          const int target = pass == 0 ? row : t * N + ENTRY_COLUMNS[k];
          real size = size_of(kind.planes, STAGE_ENTRIES, block + k);
          if (pass == 1) size *= rows[row];
          if (size > scaled[target]) scaled[target] = size;
        }
      }
    }
    for (int i = 0; i < count; i++) {
      if (!(scaled[i] > 0)) return 0;
      scaled[i] = 1 / scaled[i];
    }
  }
  return 1;
}

/* Eliminates front after front, then the Schur complement of the interface. */
static int eliminate_in(const elimination *order, matrix_kind kind, const real *values, const stage_factors *found) {
  real *a = found->matrix;
  int *pivots = found->pivots;
  const int scale_by = kind.planes * kind.copies * kind.copies;
  const int interface_order = kind.copies * order->interface;
  real *interface = a + scale_by * order->interface_start;
  memset(a, 0, (size_t)scale_by * (size_t)(order->interface_start + order->interface * order->interface) * sizeof *a);
  for (int s = 0; s < kind.copies; s++) {
    for (int t = 0; t < kind.copies; t++) {
      const real *block = values + (s * kind.copies + t) * kind.planes * STAGE_ENTRIES;
      for (int k = 0; k < STAGE_ENTRIES; k++) {
        const int number = order->entry_fronts[k];
        const int shared = number == order->front_count;
        const stage_front *own = order->fronts + number;
        const int size = shared ? interface_order : order_of(own, kind);
        const int i = shared ? s * order->interface + order->entry_rows[k] : place(own, kind, order->entry_rows[k], s);
        const int j = shared ? t * order->interface + order->entry_columns[k] : place(own, kind, order->entry_columns[k], t);
        real *target = (shared ? interface : a + scale_by * own->start) + j * kind.planes * size + i;
        const real factor = found->rows[s * N + ENTRY_ROWS[k]] * found->columns[t * N + ENTRY_COLUMNS[k]];
        for (int plane = 0; plane < kind.planes; plane++) target[plane * size] = factor * block[plane * STAGE_ENTRIES + k];
      }
    }
  }
  for (int number = 0; number < order->front_count; number++) {
    const stage_front *own = order->fronts + number;
    const int size = order_of(own, kind);
    const int members = kind.copies * own->member_count;
    real *front_matrix = a + scale_by * own->start;
    if (!eliminate_columns(kind.planes, kind.tiny, front_matrix, size, members, pivots)) return 0;
    pivots += members;
    /* The Schur complement of the front. */
    for (int j = 0; j < size - members; j++) {
      const int column = j / own->interface_count * order->interface + own->interface[j % own->interface_count];
      for (int plane = 0; plane < kind.planes; plane++) {
        const real *left = front_matrix + ((members + j) * kind.planes + plane) * size + members;
        real *target = interface + (column * kind.planes + plane) * interface_order;
        for (int i = 0; i < size - members; i++) {
          target[i / own->interface_count * order->interface + own->interface[i % own->interface_count]] += left[i];
        }
      }
    }
  }
  return eliminate_columns(kind.planes, kind.tiny, interface, interface_order, interface_order, pivots);
}

/* Factorises a system given by its entries; zero where it is singular to rounding. A rod without a pivot of its own may
   have one in the interface: then the matrix is eliminated as a whole. */
static int factorise_system(matrix_kind kind, const real *values, const stage_factors *found) {
  if (!scales_of(kind, values, found->rows, found->columns)) return 0;
  *found->as_a_whole = 0;
  if (eliminate_in(&BY_FRONTS, kind, values, found)) return 1;
  if (BY_FRONTS.front_count == 1) return 0;
  *found->as_a_whole = 1;
  return eliminate_in(&AS_A_WHOLE, kind, values, found);
}

/* Gathers the right-hand sides of one front; returns whether an entry differs from zero. */
static int gather_front(const stage_front *own, matrix_kind kind, int lanes, const real *b, real *gathered) {
  const int size = order_of(own, kind);
  const int stride = entry_stride(lanes);
  int any = 0;
  memset(gathered, 0, (size_t)(lanes * size) * sizeof *gathered);
  for (int lane = 0; lane < lanes; lane++) {
    for (int s = 0; s < kind.copies; s++) {
      const real *from = b + (lane * kind.copies + s) * N;
      real *to = gathered + lane * lane_stride(lanes, size) + s * own->member_count * stride;
      for (int i = 0; i < own->member_count; i++) {
        to[i * stride] = from[own->members[i]];
        any |= to[i * stride] != 0;
      }
    }
  }
  return any;
}

/* Writes the solution of one front to its places. */
static void scatter_front(const stage_front *own, matrix_kind kind, int lanes, const real *values, real *b) {
  const int size = order_of(own, kind);
  const int stride = entry_stride(lanes);
  for (int lane = 0; lane < lanes; lane++) {
    for (int s = 0; s < kind.copies; s++) {
      real *to = b + (lane * kind.copies + s) * N;
      const real *from = values + lane * lane_stride(lanes, size) + s * own->member_count * stride;
      for (int i = 0; i < own->member_count; i++) to[own->members[i]] = from[i * stride];
    }
  }
}

/* Adds a front's part of the interface's right-hand sides, or copies the interface's solution to the front. */
static void exchange(const stage_front *own, matrix_kind kind, int lanes, int interface_count, int give, real *values,
                     real *interface) {
  const int size = order_of(own, kind);
  const int members = kind.copies * own->member_count;
  const int stride = entry_stride(lanes);
  for (int lane = 0; lane < lanes; lane++) {
    real *own_lane = values + lane * lane_stride(lanes, size);
    real *shared = interface + lane * lane_stride(lanes, kind.copies * interface_count);
    for (int s = 0; s < kind.copies; s++) {
      for (int i = 0; i < own->interface_count; i++) {
        const int mine = (members + s * own->interface_count + i) * stride;
        const int theirs = (s * interface_count + own->interface[i]) * stride;
        if (give) {
          own_lane[mine] = shared[theirs];
        } else {
          shared[theirs] += own_lane[mine];
        }
      }
    }
  }
}

/* Solves a factorised system in place for one vector, of as many lanes as it has planes, or for FOUR real ones. b: lane
   after lane, in these one copy of the unknowns after the other. */
static void solve_system(matrix_kind kind, int lanes, const stage_factors *factors, real *b, workspace *work) {
  const elimination *order = *factors->as_a_whole ? &AS_A_WHOLE : &BY_FRONTS;
  const int matrix_scale = kind.planes * kind.copies * kind.copies;
  const int interface_order = kind.copies * order->interface;
  const int stride = entry_stride(lanes);
  const real *shared_matrix = factors->matrix + matrix_scale * order->interface_start;
  const int *pivots = factors->pivots;
  real *interface = work->interface_of_stages;
  real *values = work->fronts_of_stages;
  for (int lane = 0; lane < lanes; lane++) {
    real *shared = interface + lane * lane_stride(lanes, interface_order);
    for (int s = 0; s < kind.copies; s++) {
      real *own = b + (lane * kind.copies + s) * N;
      for (int i = 0; i < N; i++) own[i] *= factors->rows[s * N + i];
      for (int i = 0; i < order->interface; i++) {
        shared[(s * order->interface + i) * stride] = own[order->interface_members[i]];
      }
    }
  }
  for (int number = 0; number < order->front_count; number++) {
    const stage_front *own = order->fronts + number;
    const int members = kind.copies * own->member_count;
    const real *matrix = factors->matrix + matrix_scale * own->start;
    if (gather_front(own, kind, lanes, b, values)) {
      substitute_forward(lanes, matrix, order_of(own, kind), members, pivots, values);
    }
    exchange(own, kind, lanes, order->interface, 0, values, interface);
    pivots += members;
    values += lanes * order_of(own, kind);
  }
  substitute_forward(lanes, shared_matrix, interface_order, interface_order, pivots, interface);
  substitute_backward(lanes, shared_matrix, interface_order, interface_order, interface);
  values = work->fronts_of_stages;
  for (int number = 0; number < order->front_count; number++) {
    const stage_front *own = order->fronts + number;
    const real *matrix = factors->matrix + matrix_scale * own->start;
    exchange(own, kind, lanes, order->interface, 1, values, interface);
    substitute_backward(lanes, matrix, order_of(own, kind), kind.copies * own->member_count, values);
    scatter_front(own, kind, lanes, values, b);
    values += lanes * order_of(own, kind);
  }
  for (int lane = 0; lane < lanes; lane++) {
    const real *shared = interface + lane * lane_stride(lanes, interface_order);
    for (int s = 0; s < kind.copies; s++) {
      real *own = b + (lane * kind.copies + s) * N;
      for (int i = 0; i < order->interface; i++) {
        own[order->interface_members[i]] = shared[(s * order->interface + i) * stride];
      }
      for (int i = 0; i < N; i++) own[i] *= factors->columns[s * N + i];
    }
  }
}
