/* Linear systems of any size. Matrices are stored column after column. linear_dense.c has those of the Jacobian, whose size
   is known when it is compiled. */

/* Gaussian elimination with partial pivoting, in place, column after column: G. H. Golub, C. F. Van Loan, Matrix
   Computations, 4th edition, algorithm 3.4.1. The diagonal holds inverse pivots. Returns zero where one is not above the
   least of its column; null stands for zeros. */
static int factorise_square(int n, real *a, const real *least, int *pivots) {
  for (int k = 0; k < n; k++) {
    real *column = a + k * n;
    int best = k;
    for (int i = k + 1; i < n; i++) {
      if (ABSOLUTE(column[i]) > ABSOLUTE(column[best])) best = i;
    }
    pivots[k] = best;
    if (!(ABSOLUTE(column[best]) > (least ? least[k] : 0))) return 0;
    for (int j = 0; j < n && best != k; j++) {
      const real kept = a[j * n + k];
      a[j * n + k] = a[j * n + best];
      a[j * n + best] = kept;
    }
    column[k] = 1 / column[k];
    for (int i = k + 1; i < n; i++) column[i] *= column[k];
    for (int j = k + 1; j < n; j++) {
      real *target = a + j * n;
      const real factor = target[k];
      if (factor == 0) continue;
      for (int i = k + 1; i < n; i++) target[i] -= column[i] * factor;
    }
  }
  return 1;
}

/* Solves with the factors, in place. */
static void solve_square(int n, const real *a, const int *pivots, real *b) {
  for (int k = 0; k < n; k++) {
    const real kept = b[pivots[k]];
    b[pivots[k]] = b[k];
    b[k] = kept;
  }
  for (int k = 0; k < n; k++) {
    for (int i = k + 1; i < n; i++) b[i] -= a[k * n + i] * b[k];
  }
  for (int k = n - 1; k >= 0; k--) {
    b[k] *= a[k * n + k];
    for (int i = 0; i < k; i++) b[i] -= a[k * n + i] * b[k];
  }
}
