/* Linear algebra of LANES rows at once, each with its own pivots, like linear_dense.c. */

typedef long long lane_mask __attribute__((vector_size(8 * LANES), may_alias));

/* Numbers of two vectors by their places: 0 to 3 in the one, 4 to 7 in the other. */
#ifdef __clang__
#define PICKED(one, other, a, b, c, d) __builtin_shufflevector(one, other, a, b, c, d)
#else
#define PICKED(one, other, a, b, c, d) __builtin_shuffle(one, other, (lane_mask){a, b, c, d})
#endif

/* Transposes a matrix of four by four. */
#define TRANSPOSED(row_0, row_1, row_2, row_3, column_0, column_1, column_2, column_3) \
  {                                                                                    \
    const lanes even = PICKED(row_0, row_1, 0, 4, 2, 6);                               \
    const lanes odd = PICKED(row_0, row_1, 1, 5, 3, 7);                                \
    const lanes even_below = PICKED(row_2, row_3, 0, 4, 2, 6);                         \
    const lanes odd_below = PICKED(row_2, row_3, 1, 5, 3, 7);                          \
    column_0 = PICKED(even, even_below, 0, 1, 4, 5);                                   \
    column_1 = PICKED(odd, odd_below, 0, 1, 4, 5);                                     \
    column_2 = PICKED(even, even_below, 2, 3, 6, 7);                                   \
    column_3 = PICKED(odd, odd_below, 2, 3, 6, 7);                                     \
  }

#define FOUR_AT(numbers) (*(lanes *)(numbers))
#define CONSTANT_FOUR_AT(numbers) (*(const lanes *)(numbers))

void gather_lanes(const double *const *sources, int count, double *in_lanes) {
  const double *first = sources[0];
  const double *second = sources[1];
  const double *third = sources[2];
  const double *fourth = sources[3];
  lanes *gathered = (lanes *)in_lanes;
  int i = 0;
  for (; i + LANES <= count; i += LANES) {
    lanes *to = gathered + i;
    TRANSPOSED(CONSTANT_FOUR_AT(first + i), CONSTANT_FOUR_AT(second + i), CONSTANT_FOUR_AT(third + i),
               CONSTANT_FOUR_AT(fourth + i), to[0], to[1], to[2], to[3])
  }
  for (; i < count; i++) gathered[i] = (lanes){first[i], second[i], third[i], fourth[i]};
}

void scatter_lanes(const double *in_lanes, int count, double *const *targets) {
  const lanes *gathered = (const lanes *)in_lanes;
  double *first = targets[0];
  double *second = targets[1];
  double *third = targets[2];
  double *fourth = targets[3];
  int i = 0;
  for (; i + LANES <= count; i += LANES) {
    const lanes *from = gathered + i;
    TRANSPOSED(from[0], from[1], from[2], from[3], FOUR_AT(first + i), FOUR_AT(second + i), FOUR_AT(third + i),
               FOUR_AT(fourth + i))
  }
  for (; i < count; i++) {
    first[i] = gathered[i][0];
    second[i] = gathered[i][1];
    third[i] = gathered[i][2];
    fourth[i] = gathered[i][3];
  }
}

/* The numbers of the first array in masked lanes, else those of the second. */
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

/* Least size of the pivot of a column: tension makes other columns large. */
static lanes least_pivot(int size, double singular, const lanes *column, lanes tiny) {
  lanes largest = IN_ALL(1);
  for (int i = 0; i < size; i++) {
    const lanes entry = absolute(column[i]);
    largest = chosen(entry > largest, entry, largest);
  }
  largest *= singular;
  return chosen(largest < tiny, largest, tiny);
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
    int is_doubtful = 0;
    for (int lane = 0; lane < LANES; lane++) {
      const int pivot = (int)best[lane];
      pivots[k * LANES + lane] = pivot;
      if (pivot != k) swap_rows_of_lane(matrices, size, k, pivot, lane);
      is_doubtful |= largest[lane] <= tiny[lane];
    }
    const lanes least = is_doubtful ? least_pivot(size, singular, column, tiny) : tiny;
    for (int lane = 0; lane < LANES; lane++) {
      if (largest[lane] <= least[lane]) regular[lane] = 0;
    }
    const lane_mask vanishes = largest <= least;
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

/* In the order of the sums of dot. */
static lanes dot_in_lanes(int size, const lanes *a, const lanes *b) {
  lanes sums[4] = {IN_ALL(0), IN_ALL(0), IN_ALL(0), IN_ALL(0)};
  int i = 0;
  for (; i + 4 <= size; i += 4) {
    sums[0] += a[i] * b[i];
    sums[1] += a[i + 1] * b[i + 1];
    sums[2] += a[i + 2] * b[i + 2];
    sums[3] += a[i + 3] * b[i + 3];
  }
  for (; i < size; i++) sums[0] += a[i] * b[i];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void squares_in_lanes(int size, const double *in_lanes, double *squares) {
  const lanes *a = (const lanes *)in_lanes;
  *(lanes *)squares = dot_in_lanes(size, a, a);
}

void add_in_lanes(int size, const double *added, double *sums) {
  const lanes *a = (const lanes *)added;
  lanes *b = (lanes *)sums;
  for (int i = 0; i < size; i++) b[i] += a[i];
}

/* Gathers the step with a number of each lane, and the square of its length; a lane without this step gets that of
   another lane. */
static lanes gather_steps(int size, const updates_in_lanes *updates, const int *numbers, int other, double *gathered) {
  const double *sources[LANES];
  lanes squares;
  for (int lane = 0; lane < LANES; lane++) {
    const int own = numbers[lane] >= 0 && numbers[lane] < updates->counts[lane] ? lane : other;
    sources[lane] = updates->steps[own] + numbers[own] * size;
    squares[lane] = updates->squares[own][numbers[own]];
  }
  gather_lanes(sources, size, gathered);
  return squares;
}

static void updated_in_lanes(int size, const updates_in_lanes *updates, int longest, double *earlier, lanes *result) {
  double *own = earlier;
  double *next = earlier + size * LANES;
  const int most = updates->counts[longest];
  int numbers[LANES] = {0, 0, 0, 0};
  lanes squares = gather_steps(size, updates, numbers, longest, own);
  for (int j = 0; j + 1 < most; j++) {
    lane_mask has_next;
    for (int lane = 0; lane < LANES; lane++) {
      numbers[lane] = j + 1;
      has_next[lane] = j + 1 < updates->counts[lane] ? -1 : 0;
    }
    const lanes next_squares = gather_steps(size, updates, numbers, longest, next);
    const lanes share = dot_in_lanes(size, (const lanes *)own, result) / squares;
    const lanes *followers = (const lanes *)next;
    for (int i = 0; i < size; i++) result[i] = chosen(has_next, result[i] + followers[i] * share, result[i]);
    double *kept = own;
    own = next;
    next = kept;
    squares = next_squares;
  }
  for (int lane = 0; lane < LANES; lane++) numbers[lane] = updates->counts[lane] - 1;
  squares = gather_steps(size, updates, numbers, longest, own);
  lane_mask has_updates;
  for (int lane = 0; lane < LANES; lane++) has_updates[lane] = updates->counts[lane] > 0 ? -1 : 0;
  const lanes share = 1 - dot_in_lanes(size, (const lanes *)own, result) / squares;
  const lanes factor = chosen(has_updates, 1 / share, IN_ALL(1));
  for (int i = 0; i < size; i++) result[i] *= factor;
}

void complete_steps_in_lanes(int size, const updates_in_lanes *updates, double *earlier, double *steps) {
  int longest = 0;
  for (int lane = 1; lane < LANES; lane++) {
    if (updates->counts[lane] > updates->counts[longest]) longest = lane;
  }
  if (updates->counts[longest] > 0) updated_in_lanes(size, updates, longest, earlier, (lanes *)steps);
}
