/* Linear algebra of LANES rows at once, each with pivots of its own: as linear_dense.c. */

void gather_lanes(const double *const *sources, int count, double *in_lanes) {
  const double *first = sources[0];
  const double *second = sources[1];
  const double *third = sources[2];
  const double *fourth = sources[3];
  lanes *gathered = (lanes *)in_lanes;
  for (int i = 0; i < count; i++) gathered[i] = (lanes){first[i], second[i], third[i], fourth[i]};
}

void scatter_lanes(const double *in_lanes, int count, int used, double *const *targets) {
  for (int lane = 0; lane < used; lane++) {
    double *target = targets[lane];
    for (int i = 0; i < count; i++) target[i] = in_lanes[i * LANES + lane];
  }
}

typedef long long lane_mask __attribute__((vector_size(8 * LANES), may_alias));

/* The numbers of one where the mask says so, else of the other. */
static lanes chosen(lane_mask mask, lanes one, lanes other) {
  return (lanes)((mask & (lane_mask)one) | (~mask & (lane_mask)other));
}

static lanes absolute(lanes x) { return chosen(x < 0, -x, x); }

static void swap_rows_of_lane(double *a, int size, int k, int m, int lane) {
  for (int j = 0; j < size; j++) {
    double *column = a + j * size * LANES + lane;
    const double kept = column[k * LANES];
    column[k * LANES] = column[m * LANES];
    column[m * LANES] = kept;
  }
}

void factorise_in_lanes(int size, double singular, double *matrices, int *pivots, int *regular, int *finite) {
  lanes *a = (lanes *)matrices;
  lanes tiny = IN_ALL(0);
  lanes zero = IN_ALL(0);
  for (int i = 0; i < size * size; i++) {
    const lanes entry = absolute(a[i]);
    tiny = chosen(entry > tiny, entry, tiny);
    zero += a[i] * 0;
  }
  tiny *= singular;
  for (int lane = 0; lane < LANES; lane++) {
    regular[lane] = 1;
    finite[lane] = zero[lane] == 0;
  }
  for (int k = 0; k < size; k++) {
    lanes *column = a + k * size;
    lanes largest = absolute(column[k]);
    lanes best = IN_ALL(0) + (double)k;
    for (int i = k + 1; i < size; i++) {
      const lanes entry = absolute(column[i]);
      const lane_mask larger = entry > largest;
      largest = chosen(larger, entry, largest);
      best = chosen(larger, IN_ALL(0) + (double)i, best);
    }
    for (int lane = 0; lane < LANES; lane++) {
      const int pivot = (int)best[lane];
      pivots[k * LANES + lane] = pivot;
      if (pivot != k) swap_rows_of_lane(matrices, size, k, pivot, lane);
      if (largest[lane] <= tiny[lane]) regular[lane] = 0;
    }
    const lane_mask vanishes = largest <= tiny;
    column[k] = chosen(vanishes, IN_ALL(0), 1 / column[k]);
    for (int i = k + 1; i < size; i++) column[i] *= column[k];
    for (int j = k + 1; j < size; j++) {
      lanes *target = a + j * size;
      const lanes factor = target[k];
      for (int i = k + 1; i < size; i++) target[i] -= column[i] * factor;
    }
  }
}

void permute_in_lanes(int size, const int *pivots, double *right_sides) {
  for (int k = 0; k < size; k++) {
    for (int lane = 0; lane < LANES; lane++) {
      double *right_side = right_sides + lane;
      const int pivot = pivots[k * LANES + lane] * LANES;
      const double kept = right_side[pivot];
      right_side[pivot] = right_side[k * LANES];
      right_side[k * LANES] = kept;
    }
  }
}

void substitute_in_lanes(int size, const double *factors, double *right_sides) {
  const lanes *a = (const lanes *)factors;
  lanes *b = (lanes *)right_sides;
  for (int k = 0; k < size; k++) {
    const lanes known = b[k];
    for (int i = k + 1; i < size; i++) b[i] -= a[k * size + i] * known;
  }
  for (int k = size - 1; k >= 0; k--) {
    const lanes known = b[k] * a[k * size + k];
    b[k] = known;
    for (int i = 0; i < k; i++) b[i] -= a[k * size + i] * known;
  }
}
