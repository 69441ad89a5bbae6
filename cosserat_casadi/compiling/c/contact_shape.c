/* Shapes of rods: from the elements of one arrangement to those of another, and distances from obstacles. */

#include "interpolation.c"

/* The element of a rod that contains an abscissa; an inner end belongs to the element before it. */
static int element_at(const arrangement *at, const real *z, int rod, real X) {
  int e = 0;
  while (e + 1 < at->rods[rod].elements && X > end_of_element(at, z, rod, e + 1)) e++;
  return e;
}

/* Position of an abscissa in its element, from 0 to 1. */
static real local_abscissa(const arrangement *at, const real *z, int rod, int element, real X) {
  const real start = end_of_element(at, z, rod, element);
  const real end = end_of_element(at, z, rod, element + 1);
  return smaller(larger((X - start) / (end - start), 0), 1);
}

/* Sum of polynomials of an element with these coefficients. */
static real polynomial(int is_chebyshev, const real *coefficients, int count, real local) {
  const real u = 2 * local - 1;
  real before = 0, value = 1, sum = 0;
  for (int k = 0; k < count; k++) {
    sum += coefficients[k] * value;
    const real next = is_chebyshev ? (k == 0 ? u : 2 * u * value - before)
                                   : ((2 * k + 1) * u * value - k * before) / (k + 1);
    before = value;
    value = next;
  }
  return sum;
}

static real nominal_width(const rod_elements *elements, int e) { return elements->nominal[e + 1] - elements->nominal[e]; }

/* Strain of a component at an abscissa, in the scale of its coordinates, which refer to the nominal width. */
static real strain_at(const arrangement *at, const real *z, int rod, int first, int modes, real X) {
  const rod_elements *elements = at->rods + rod;
  const int e = element_at(at, z, rod, X);
  const real width = end_of_element(at, z, rod, e + 1) - end_of_element(at, z, rod, e);
  const real local = local_abscissa(at, z, rod, e, X);
  const real value = polynomial(ROD[rod].is_chebyshev, z + first + e * modes, modes, local);
  return value * nominal_width(elements, e) / width;
}

/* Fits the shape `old` by the unknowns of another arrangement, whose places stand in z already; forces are zero. */
static void project(const arrangement *from, const real *old, const arrangement *to, real *z) {
  for (int rod = 0; rod < RODS; rod++) {
    const rod_modes *own = to->modes + rod;
    const rod_elements *elements = to->rods + rod;
    int old_first = from->rods[rod].first_strain;
    int first = elements->first_strain;
    for (int c = 0; c < ROD[rod].components; c++) {
      const int old_modes = from->modes[rod].modes[c];
      const int modes = own->modes[c];
      for (int e = 0; e < elements->elements; e++) {
        const real start = end_of_element(to, z, rod, e);
        const real width = end_of_element(to, z, rod, e + 1) - start;
        real *target = z + first + e * modes;
        for (int m = 0; m < modes; m++) target[m] = 0;
        for (int k = 0; k < own->points; k++) {
          const real X = start + own->local_points[k] * width;
          const real strain = strain_at(from, old, rod, old_first, old_modes, X) * width / nominal_width(elements, e);
          for (int m = 0; m < modes; m++) target[m] += own->fits[c][m * own->points + k] * strain;
        }
      }
      old_first += old_modes * from->rods[rod].elements;
      first += modes * elements->elements;
    }
  }
  /* Multipliers and tensions do not depend on the elements. */
  memcpy(z + to->strains, old + from->strains, (size_t)(to->unknowns - to->strains) * sizeof *z);
  for (int i = 0; i < to->forces; i++) z[to->unknowns + i] = 0;
}

/* Forces that balance a shape best in least squares: the balance is linear in them. Columns that add little are left
   out. */
static void fit_forces(const arrangement *at, const real *inputs, real *z, workspace *work) {
  const int n = at->size;
  const int unknowns = at->unknowns;
  real *rest = work->trial_residual;
  real *columns = work->columns;
  int order[CONTACT_FORCES + 1];
  real triangle[(CONTACT_FORCES + 1) * (CONTACT_FORCES + 1)];
  real shares[CONTACT_FORCES + 1];
  if (at->forces == 0 || !isfinite(residual_at(at, z, inputs, rest, work))) return;
  work->jacobian_of = -1;
  call(at->jacobian, z, inputs, work->jacobian, 0, work);
  for (int j = 0; j < at->forces; j++) {
    memcpy(columns + j * unknowns, work->jacobian + (unknowns + j) * n, (size_t)unknowns * sizeof *columns);
    order[j] = j;
  }
  /* Modified Gram-Schmidt; the largest remaining column comes next. */
  int rank = 0;
  real first_norm = 0;
  for (int k = 0; k < at->forces; k++) {
    int best = k;
    real best_norm = 0;
    for (int j = k; j < at->forces; j++) {
      const real norm = norm_of(columns + order[j] * unknowns, unknowns);
      if (norm > best_norm) {
        best_norm = norm;
        best = j;
      }
    }
    if (k == 0) first_norm = best_norm;
    if (!(best_norm > FIT * first_norm)) break;
    const int chosen = order[best];
    order[best] = order[k];
    order[k] = chosen;
    for (int i = 0; i < k; i++) {
      /* The coefficients of earlier projections stand in the column's place. */
      const real kept = triangle[i * (CONTACT_FORCES + 1) + best];
      triangle[i * (CONTACT_FORCES + 1) + best] = triangle[i * (CONTACT_FORCES + 1) + k];
      triangle[i * (CONTACT_FORCES + 1) + k] = kept;
    }
    real *unit = columns + chosen * unknowns;
    for (int i = 0; i < unknowns; i++) unit[i] /= best_norm;
    triangle[k * (CONTACT_FORCES + 1) + k] = best_norm;
    for (int j = k + 1; j < at->forces; j++) {
      real *other = columns + order[j] * unknowns;
      const real share = dot(unit, other, unknowns);
      triangle[k * (CONTACT_FORCES + 1) + j] = share;
      for (int i = 0; i < unknowns; i++) other[i] -= share * unit[i];
    }
    shares[k] = -dot(unit, rest, unknowns);
    for (int i = 0; i < unknowns; i++) rest[i] += shares[k] * unit[i];
    rank = k + 1;
  }
  for (int k = rank - 1; k >= 0; k--) {
    real value = shares[k];
    for (int j = k + 1; j < rank; j++) {
      value -= triangle[k * (CONTACT_FORCES + 1) + j] * z[unknowns + order[j]];
    }
    z[unknowns + order[k]] = value / triangle[k * (CONTACT_FORCES + 1) + k];
  }
}

/* Abscissa of the first section of the owner of contacts. */
static real first_section(int owner) { return owner < RODS ? 0 : 1; }

/* Position of the section at an abscissa, from the positions of all nodes, behind which are those of bodies. */
static void position_at(const arrangement *at, const real *z, const real *nodes, int rod, real X, real *position) {
  if (rod >= RODS) {
    memcpy(position, nodes + 3 * (at->nodes_of_rods + rod - RODS), 3 * sizeof *position);
    return;
  }
  const rod_modes *own = at->modes + rod;
  const int count = own->intervals + 1;
  const int e = element_at(at, z, rod, X);
  const real local = local_abscissa(at, z, rod, e, X);
  const real *first = nodes + 3 * (at->rods[rod].first_node + e * count);
  point_of_curve(first, own->local_nodes, own->barycentric, count, local, position);
}

/* Distance of the surface of a section from an obstacle, over the length of the rod. */
static real gap_at(const pair_entry *pair, const real *position, real X, workspace *work) {
  const rod_entry *own = ROD + pair->rod;
  real distance;
  call(pair->distance, position, 0, &distance, 0, work);
  const real radius = own->radius_at_base + X * (own->radius_at_tip - own->radius_at_base);
  return (distance - radius) / own->length;
}

/* Whether a section on its straight way enters an obstacle. */
static int leads_through(const pair_entry *pair, real X, const real *start, const real *end, real way, workspace *work) {
  const real before = larger(gap_at(pair, start, X, work), 0);
  const real after = larger(gap_at(pair, end, X, work), 0);
  const real length = ROD[pair->rod].length;
  /* A distance changes by at most the way: on a shorter way the section cannot have met the obstacle. */
  if (way <= (before + after) * length) return 0;
  const int looks = (int)smaller(larger(way / (STRIDE * length), 1), MOST_LOOKS);
  for (int k = 1; k <= looks; k++) {
    const real share = (real)k / (looks + 1);
    real position[3];
    for (int i = 0; i < 3; i++) position[i] = start[i] + share * (end[i] - start[i]);
    if (gap_at(pair, position, X, work) < -DEEP) return 1;
  }
  return 0;
}

/* Distance along the rod, over its length, within which no other section can pass through an obstacle either: gaps and
   ways change by at most the change of X, apart from stretch and taper. */
static real clear_distance(const pair_entry *pair, real X, const real *start, const real *end, real way, workspace *work) {
  const real share = way / ROD[pair->rod].length;
  /* Beside sections that hardly move, others move by less than twice the depth that counts. */
  if (share <= DEEP / 2) return FARTHEST;
  const real gaps = larger(gap_at(pair, start, X, work), 0) + larger(gap_at(pair, end, X, work), 0);
  return larger(larger((gaps - share) / 4, DEEP - share / 2) / FASTEST, CLOSEST);
}

#ifdef RODS_TOUCH_RODS
static int rods_pass(const arrangement *from, const real *old, const arrangement *to, const real *z, workspace *work);

#endif
/* Whether, from one shape to the other, every section moves little and none passes through an obstacle. The nodes of
   both shapes stand in the workspace. Each step along the rod is at least CLOSEST. */
static int is_near(const arrangement *from, const real *old, const arrangement *to, const real *z, workspace *work) {
  for (int rod = 0; rod < OWNERS; rod++) {
    real X = first_section(rod);
    for (;;) {
      real start[3], end[3], change[3];
      position_at(from, old, work->nodes_before, rod, X, start);
      position_at(to, z, work->nodes, rod, X, end);
      for (int i = 0; i < 3; i++) change[i] = end[i] - start[i];
      const real way = norm_of(change, 3);
      if (!(way <= LONGEST_WAY * ROD[rod].length)) return 0;
      real step = FARTHEST;
      for (int p = 0; p < PAIRS; p++) {
        if (PAIR[p].rod != rod) continue;
#ifdef RODS_TOUCH_RODS
        if (other_rod(PAIR[p].obstacle) >= 0) continue;
#endif
        if (leads_through(PAIR + p, X, start, end, way, work)) return 0;
        step = smaller(step, clear_distance(PAIR + p, X, start, end, way, work));
      }
      if (X == 1) break;
      X = smaller(X + step, 1);
    }
  }
#ifdef RODS_TOUCH_RODS
  if (rods_pass(from, old, to, z, work)) return 0;
#endif
  return 1;
}
