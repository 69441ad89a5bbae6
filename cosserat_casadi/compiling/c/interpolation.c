/* A point of a curve between its nodes in an element: J.-P. Berrut, L. N. Trefethen, Barycentric Lagrange interpolation,
   SIAM Review 46 (2004). The curve is given by its positions at the nodes, the point by its place between 0 and 1. */
static void point_of_curve(const real *positions, const real *local_nodes, const real *barycentric, int count, real local,
                           real *point) {
  real sum = 0;
  for (int i = 0; i < 3; i++) point[i] = 0;
  for (int k = 0; k < count; k++) {
    const real difference = local - local_nodes[k];
    if (fabs(difference) < 1e-300) {
      memcpy(point, positions + 3 * k, 3 * sizeof *point);
      return;
    }
    const real weight = barycentric[k] / difference;
    sum += weight;
    for (int i = 0; i < 3; i++) point[i] += weight * positions[3 * k + i];
  }
  for (int i = 0; i < 3; i++) point[i] /= sum;
}
