/* Whether states of a scene that is touched exactly are inside an obstacle, or beyond one that a way leads through. Uses of
   the scene: FACING, point_count, positions_of. */

/* Number of the pairs, the first, that bar a way. */
#ifndef BARRING
#define BARRING FACINGS
#endif

/* Whether anything is deeper inside an obstacle than a bound, or where that is no number. */
static int is_inside(const real *x, const real *inputs, real depth, workspace *work) {
  section_gap lowest;
  for (int k = 0; k < FACINGS; k++) {
    const facing *own = FACING + k;
    positions_of(own, x, inputs, work->nodes, work);
    if (!all_finite(work->nodes, 3 * point_count(own))) return 1;
    look_along(own, work->nodes, work);
    if (next_valley(own, 0, -depth, 1, &lowest, work)) return 1;
  }
  return 0;
}

/* Positions of the points of a pair at both ends of a way, in the workspace; returns the longest way of one, m. */
static real way_of_points(const facing *own, const real *x, const real *inputs, const real *next, const real *next_inputs,
                          workspace *work) {
  real longest = 0;
  positions_of(own, x, inputs, work->nodes, work);
  positions_of(own, next, next_inputs, work->weights, work);
  for (int i = 0; i < point_count(own); i++) {
    real way[3];
    for (int k = 0; k < 3; k++) way[k] = work->weights[3 * i + k] - work->nodes[3 * i + k];
    const real length = SQUARE_ROOT(inner(way, way));
    if (!(length <= longest)) longest = length;
  }
  return longest;
}

/* Whether the straight way of all points from one shape to another leads into an obstacle, or through a thin one, or where
   that is no number. */
static int leads_inside(const real *x, const real *inputs, const real *next, const real *next_inputs, workspace *work) {
  section_gap lowest;
  for (int number = 0; number < BARRING; number++) {
    const facing *own = FACING + number;
    const real longest = way_of_points(own, x, inputs, next, next_inputs, work);
    if (!isfinite(longest)) return 1;
    const int looks = 1 + (int)(longest / own->stride);
    for (int look = 1; look <= looks; look++) {
      const real share = (real)look / (real)looks;
      for (int i = 0; i < 3 * point_count(own); i++) {
        work->between[i] = (1 - share) * work->nodes[i] + share * work->weights[i];
      }
      look_along(own, work->between, work);
      if (next_valley(own, 0, -TOUCHING, 1, &lowest, work)) return 1;
    }
  }
  return 0;
}
