/* Second variation of the energy over the admissible variations, and whether an equilibrium is stable.

   The null-space method: J. Nocedal, S. J. Wright, Numerical Optimization, 2nd edition, section 16.2. Eigenvalues by
   Householder's tridiagonalisation and implicit QR steps with Wilkinson's shift: G. H. Golub, C. F. Van Loan, Matrix
   Computations, 4th edition, sections 5.4.2, 8.3.1 and 8.3.5. cosserat_casadi/equilibrium/stability.py and judge.py hold the
   same in Python. Matrices are stored column after column.

   A part of the source of the stability of a library. Uses N, FREE, HELD, FREE_UNKNOWNS, HELD_UNKNOWNS, ROOTS, ZERO,
   DEPENDENT, TOLERANCE, ASIDE, jacobian_at, solve. Gives: stability. */
#ifndef STABLE
#error "This file is a part of the source of the stability of a library: compile that one."
#endif

#include <math.h>
#include <string.h>

#ifdef SINGLE
#define SQUARE_ROOT sqrtf
#define ABSOLUTE fabsf
static const real PRECISION = (real)1.2e-7;
#else
#define SQUARE_ROOT sqrt
#define ABSOLUTE fabs
static const real PRECISION = (real)2.2e-16;
#endif
static const int QR_STEPS = 30;     /* most of them for one eigenvalue */
static const real RIGID = (real)1e4; /* stiffness of a cable or a stop, in EI/L, above which it does not yield */

static real norm_of(const real *a, int count) {
  real sum = 0;
  for (int i = 0; i < count; i++) sum += a[i] * a[i];
  return SQUARE_ROOT(sum);
}

/* A reflector I - factor v v' that turns the entries of v from first on into (value, 0, ..): writes v, returns the
   factor. */
static real reflector_of(real *v, int first, real *value) {
  const real length = norm_of(v + first, FREE - first);
  if (length == 0) {
    *value = 0;
    return 0;
  }
  const real head = v[first];
  *value = head > 0 ? -length : length;
  v[first] = head - *value;
  return 1 / (length * (length + ABSOLUTE(head)));
}

/* A symmetric matrix between two reflectors, in its rows and columns from first on. */
static void reflect(real *matrix, const real *v, int first, real factor, real *image) {
  real share = 0;
  for (int j = first; j < FREE; j++) image[j] = 0;
  for (int j = first; j < FREE; j++) {
    const real *column = matrix + j * FREE;
    for (int i = first; i < FREE; i++) image[i] += column[i] * v[j];
  }
  for (int j = first; j < FREE; j++) share += image[j] * v[j];
  share *= factor / 2;
  for (int j = first; j < FREE; j++) image[j] = factor * (image[j] - share * v[j]);
  for (int j = first; j < FREE; j++) {
    real *column = matrix + j * FREE;
    for (int i = first; i < FREE; i++) column[i] -= v[i] * image[j] + image[i] * v[j];
  }
}

/* A matrix times a reflector from the right, in its columns from first on. */
static void reflect_columns(real *matrix, const real *v, int first, real factor, real *image) {
  for (int i = 0; i < FREE; i++) image[i] = 0;
  for (int j = first; j < FREE; j++) {
    for (int i = 0; i < FREE; i++) image[i] += matrix[j * FREE + i] * v[j];
  }
  for (int j = first; j < FREE; j++) {
    for (int i = 0; i < FREE; i++) matrix[j * FREE + i] -= factor * image[i] * v[j];
  }
}

/* Whether the equation of a held unknown gives it a finite stiffness or none, as for a slack or elastic cable or an
   elastic stop. */
static int yields(const memory *room, int row) {
  const real own = ABSOLUTE(room->jacobian[row * N + row]);
  real gradient = 0, pull = 0;
  for (int i = 0; i < FREE; i++) {
    const real g = room->jacobian[FREE_UNKNOWNS[i] * N + row], p = room->jacobian[row * N + FREE_UNKNOWNS[i]];
    gradient += g * g;
    pull += p * p;
  }
  return own > 0 && SQUARE_ROOT(gradient) * SQUARE_ROOT(pull) <= RIGID * own;
}

/* Symmetric part of the scaled Jacobian in room->jacobian by the free unknowns; yielding unknowns are condensed out. */
static void gather_hessian(memory *room) {
  for (int j = 0; j < FREE; j++) {
    for (int i = 0; i <= j; i++) {
      const int row = FREE_UNKNOWNS[i], column = FREE_UNKNOWNS[j];
      const real upper = ROOTS[i] * room->jacobian[column * N + row] / ROOTS[j];
      const real lower = ROOTS[j] * room->jacobian[row * N + column] / ROOTS[i];
      room->hessian[j * FREE + i] = room->hessian[i * FREE + j] = (upper + lower) / 2;
    }
  }
  for (int k = 0; k < HELD; k++) {
    const int row = HELD_UNKNOWNS[k];
    if (!yields(room, row)) continue;
    const real own = room->jacobian[row * N + row];
    for (int j = 0; j < FREE; j++) {
      for (int i = 0; i < FREE; i++) {
        const real pull = ROOTS[i] * room->jacobian[row * N + FREE_UNKNOWNS[i]] / own;
        const real followed = pull * room->jacobian[FREE_UNKNOWNS[j] * N + row] / ROOTS[j];
        room->hessian[j * FREE + i] -= followed / 2;
        room->hessian[i * FREE + j] -= followed / 2;
      }
    }
  }
}

/* Linearised constraints that restrict the variations, one a column; returns their number. */
static int gather_constraints(memory *room) {
  int count = 0;
  for (int k = 0; k < HELD; k++) {
    const int row = HELD_UNKNOWNS[k];
    if (yields(room, row)) continue;
    real *column = room->constraints + count * FREE;
    for (int i = 0; i < FREE; i++) column[i] = room->jacobian[FREE_UNKNOWNS[i] * N + row] / ROOTS[i];
    count++;
  }
  return count;
}

/* Swaps the column with the longest remainder, among columns from first on, to the place first. */
static void choose_column(real *columns, int first, int count) {
  int best = first;
  real longest = -1;
  for (int k = first; k < count; k++) {
    const real length = norm_of(columns + k * FREE + first, FREE - first);
    if (length > longest) {
      longest = length;
      best = k;
    }
  }
  for (int i = 0; i < FREE; i++) {
    const real kept = columns[first * FREE + i];
    columns[first * FREE + i] = columns[best * FREE + i];
    columns[best * FREE + i] = kept;
  }
}

/* Rotates the variations by QR with column pivoting so that the constraints depend on the first ones only. Returns
   their number, the rank. The matrix of variations may be null. */
static int eliminate_constraints(memory *room, real *vectors) {
  const int count = gather_constraints(room);
  real first_pivot = 0;
  int rank = 0;
  for (; rank < count && rank < FREE; rank++) {
    real pivot;
    real *v = room->constraints + rank * FREE;
    choose_column(room->constraints, rank, count);
    const real factor = reflector_of(v, rank, &pivot);
    if (rank == 0) first_pivot = ABSOLUTE(pivot);
    if (ABSOLUTE(pivot) <= DEPENDENT * first_pivot) break;
    for (int k = rank + 1; k < count; k++) {
      real *other = room->constraints + k * FREE;
      real share = 0;
      for (int i = rank; i < FREE; i++) share += v[i] * other[i];
      for (int i = rank; i < FREE; i++) other[i] -= factor * share * v[i];
    }
    reflect(room->hessian, v, rank, factor, room->image);
    if (vectors) reflect_columns(vectors, v, rank, factor, room->image);
  }
  return rank;
}

/* Makes the rows and columns of the matrix from first on tridiagonal: diagonal, and the entries beside it. */
static void tridiagonalise(memory *room, int first, real *vectors) {
  real *v = room->reflector;
  for (int k = first; k < FREE; k++) {
    room->eigenvalues[k] = room->hessian[k * FREE + k];
    if (k + 1 == FREE) break;
    for (int i = k + 1; i < FREE; i++) v[i] = room->hessian[k * FREE + i];
    const real factor = reflector_of(v, k + 1, room->beside_diagonal + k);
    if (factor == 0) continue;
    reflect(room->hessian, v, k + 1, factor, room->image);
    if (vectors) reflect_columns(vectors, v, k + 1, factor, room->image);
  }
}

/* One implicit QR step on rows and columns low to high of a tridiagonal matrix. */
static void qr_step(real *diagonal, real *beside, int low, int high, real *vectors) {
  const real half = (diagonal[high - 1] - diagonal[high]) / 2;
  const real last = beside[high - 1];
  const real root = SQUARE_ROOT(half * half + last * last);
  const real shift = diagonal[high] - last * last / (half + (half > 0 ? root : -root));
  real x = diagonal[low] - shift;
  real z = beside[low];
  for (int k = low; k < high; k++) {
    const real length = SQUARE_ROOT(x * x + z * z);
    const real c = length == 0 ? 1 : x / length;
    const real s = length == 0 ? 0 : z / length;
    if (k > low) beside[k - 1] = length;
    const real a = diagonal[k], b = beside[k], d = diagonal[k + 1];
    diagonal[k] = c * c * a + 2 * c * s * b + s * s * d;
    diagonal[k + 1] = s * s * a - 2 * c * s * b + c * c * d;
    beside[k] = c * s * (d - a) + (c * c - s * s) * b;
    if (k + 1 < high) {
      x = beside[k];
      z = s * beside[k + 1];
      beside[k + 1] *= c;
    }
    for (int i = 0; vectors && i < FREE; i++) {
      const real left = vectors[k * FREE + i], right = vectors[(k + 1) * FREE + i];
      vectors[k * FREE + i] = c * left + s * right;
      vectors[(k + 1) * FREE + i] = c * right - s * left;
    }
  }
}

/* Computes the eigenvalues of the tridiagonal matrix from first on into its diagonal, unordered. Returns zero if it
   fails. */
static int diagonalise(memory *room, int first, real *vectors) {
  real *diagonal = room->eigenvalues, *beside = room->beside_diagonal;
  real largest = 0;
  for (int k = first; k < FREE; k++) {
    const real off = k + 1 < FREE ? ABSOLUTE(beside[k]) : 0;
    if (ABSOLUTE(diagonal[k]) + off > largest) largest = ABSOLUTE(diagonal[k]) + off;
  }
  if (!isfinite(largest)) return 0;
  const real tiny = PRECISION * largest;
  int steps = 0;
  for (int high = FREE - 1; high > first;) {
    if (ABSOLUTE(beside[high - 1]) <= tiny) {
      high--;
      continue;
    }
    int low = high - 1;
    while (low > first && ABSOLUTE(beside[low - 1]) > tiny) low--;
    if (++steps > QR_STEPS * FREE) return 0;
    qr_step(diagonal, beside, low, high, vectors);
  }
  return 1;
}

/* Eigenvalues of the second variation at x, from the returned place on in room->eigenvalues; -1 where they are not found.
   With vectors the variations that belong to them, one a column, scaled by ROOTS. */
static int spectrum(memory *room, real *vectors) {
  if (vectors) {
    memset(vectors, 0, FREE * FREE * sizeof *vectors);
    for (int i = 0; i < FREE; i++) vectors[i * FREE + i] = 1;
  }
  gather_hessian(room);
  const int first = eliminate_constraints(room, vectors);
  tridiagonalise(room, first, vectors);
  return diagonalise(room, first, vectors) ? first : -1;
}

/* Verdict by the eigenvalues from first on; room->neutral receives the zero ones. */
static void judge(memory *room, int first, verdict_info *info) {
  real largest = 1;
  info->smallest_eigenvalue = INFINITY;
  info->negative = 0;
  info->zero = 0;
  for (int k = first; k < FREE; k++) {
    const real value = room->eigenvalues[k];
    if (ABSOLUTE(value) > largest) largest = ABSOLUTE(value);
    if (value < info->smallest_eigenvalue) info->smallest_eigenvalue = value;
  }
  for (int k = first; k < FREE; k++) {
    const real value = room->eigenvalues[k];
    if (value < -ZERO * largest) info->negative++;
    else if (value <= ZERO * largest) room->neutral[info->zero++] = k;
  }
  info->verdict = info->negative ? UNSTABLE : info->zero ? NEUTRAL : STABLE;
}

/* Distance of two points in the free unknowns. Multipliers do not count: they turn with a rod, and are large if it is
   held tight. */
static real distance_between(const real *one, const real *other, memory *room) {
  for (int i = 0; i < FREE; i++) room->image[i] = one[FREE_UNKNOWNS[i]] - other[FREE_UNKNOWNS[i]];
  return norm_of(room->image, FREE);
}

/* Whether an equivalent equilibrium lies a little way along a variation. Newton may return to the first one, or go
   elsewhere: neither says anything about this variation. */
static int is_alike_beside(const problem *at, const real *x, const real *variation, memory *room) {
  verdict_info found;
  real *beside = room->beside;
  memcpy(beside, x, N * sizeof *x);
  for (int i = 0; i < FREE; i++) beside[FREE_UNKNOWNS[i]] += ASIDE * variation[i] / ROOTS[i];
  if (!solve(at, beside)) return 0;
  const real distance = distance_between(beside, x, room);
  if (distance < ASIDE / 2 || distance > 2 * ASIDE) return 0;
  jacobian_at(at, beside, room->jacobian, room->residual);
  const int first = spectrum(room, 0);
  if (first < 0) return 0;
  judge(room, first, &found);
  return found.verdict == NEUTRAL;
}

static status stability(const problem *at, const real *x, memory *room, verdict_info *info) {
  const real size = 1 + norm_of(x, N);
  if (!isfinite(size)) return NOT_FINITE;
  jacobian_at(at, x, room->jacobian, room->residual);
  for (int i = 0; i < N * N; i++) {
    if (!isfinite(room->jacobian[i])) return NOT_FINITE;
  }
  if (!(norm_of(room->residual, N) <= 10 * TOLERANCE * size)) return NOT_IN_EQUILIBRIUM;
  const int first = spectrum(room, 0);
  if (first < 0) return NOT_FINITE;
  judge(room, first, info);
  if (info->verdict != NEUTRAL) return CONVERGED;
  /* Only neutral equilibria need the variations: repeat with them. */
  const int again = spectrum(room, room->vectors);
  if (again < 0) return NOT_FINITE;
  judge(room, again, info);
  const int count = info->zero;
  int neutral[FREE];
  memcpy(neutral, room->neutral, sizeof neutral);
  for (int k = 0; k < count; k++) {
    if (!is_alike_beside(at, x, room->vectors + neutral[k] * FREE, room)) {
      info->verdict = CRITICAL;
      break;
    }
  }
  return CONVERGED;
}
