/* Static functions of the solver and of the dense linear algebra, one by one. Ends with the line of what failed. */
#include "@{name}.c"

#include "units.h"

static workspace work;

static void random_matrix(real *a, int count) {
  for (int i = 0; i < count; i++) a[i] = uniform();
}

/* Ax = b with a known x; then with a column twice, which has no regular factors. */
static int test_factorise(void) {
  real a[N * N], x[N], b[N];
  jacobian_factors factors;
  for (int trial = 0; trial < 50; trial++) {
    random_matrix(a, N * N);
    random_matrix(x, N);
    /* Zeros on the diagonal: without pivoting there would be no factors. */
    for (int i = 0; i < N; i++) a[i * N + i] = 0;
    product(a, x, b, N);
    memcpy(factors.factors, a, sizeof a);
    CHECK(factorise(factors.factors, factors.pivots));
    back_substitute(&factors, b, &work);
    CHECK(distance(x, b, N) < 1e-9);
    memcpy(a + N, a, N * sizeof *a);
    memcpy(factors.factors, a, sizeof a);
    CHECK(!factorise(factors.factors, factors.pivots));
    back_substitute(&factors, b, &work);
    CHECK(all_finite(b, N));
  }
  return 0;
}

int main(void) {
  const int line = test_factorise();
  return line ? line : test_solver(&work);
}
