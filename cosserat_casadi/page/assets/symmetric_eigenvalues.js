// Eigenvalues of small symmetric matrices, and with them the stability of an equilibrium. Matrices are arrays of rows.

// Eigenvalues and, one a column, eigenvectors by Jacobi's rotations: Golub, Van Loan, Matrix Computations, section 8.5.
function eigen(symmetric) {
  const n = symmetric.length;
  const a = symmetric.map((row) => Float64Array.from(row));
  const vectors = a.map((_, i) => Float64Array.from({ length: n }, (_, j) => (i === j ? 1 : 0)));
  const size = Math.hypot(...a.map((row) => Math.hypot(...row)));
  for (let sweep = 0; sweep < 60; sweep++) {
    let outside = 0;
    for (let p = 0; p < n; p++) for (let q = 0; q < p; q++) outside = Math.max(outside, Math.abs(a[p][q]));
    if (outside <= 1e-15 * size) break;
    for (let p = 0; p < n; p++) {
      for (let q = p + 1; q < n; q++) if (a[p][q] !== 0) rotate(a, vectors, p, q);
    }
  }
  return { values: a.map((row, i) => row[i]), vectors };
}

// One rotation in the plane of two axes that makes the entry between them zero.
function rotate(a, vectors, p, q) {
  const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const tangent = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.hypot(theta, 1));
  const cosine = 1 / Math.hypot(tangent, 1);
  const sine = tangent * cosine;
  const n = a.length;
  for (let k = 0; k < n; k++) {
    const kp = a[k][p];
    const kq = a[k][q];
    a[k][p] = cosine * kp - sine * kq;
    a[k][q] = sine * kp + cosine * kq;
  }
  for (let k = 0; k < n; k++) {
    const pk = a[p][k];
    const qk = a[q][k];
    a[p][k] = cosine * pk - sine * qk;
    a[q][k] = sine * pk + cosine * qk;
    const vp = vectors[k][p];
    const vq = vectors[k][q];
    vectors[k][p] = cosine * vp - sine * vq;
    vectors[k][q] = sine * vp + cosine * vq;
  }
}

// An orthonormal basis of what the rows of a matrix are blind to, one vector a row: Gram and Schmidt, done twice.
function nullSpace(rows, n) {
  const basis = [];
  const against = (vector, others) => {
    for (const other of [...others, ...others]) {
      const share = other.reduce((sum, value, i) => sum + value * vector[i], 0);
      for (let i = 0; i < n; i++) vector[i] -= share * other[i];
    }
    return Math.hypot(...vector);
  };
  const take = (vector, into, others, least) => {
    const length = Math.hypot(...vector);
    const left = against(vector, others);
    if (left > least * length) into.push(vector.map((value) => value / left));
  };
  const range = [];
  for (const row of rows) take(Float64Array.from(row), range, range, 1e-12);
  // Unit vectors, those first that the rows say least of: the rest of the space is spanned without small differences.
  const said = Array.from({ length: n }, (_, i) => [Math.hypot(...range.map((row) => row[i])), i]).sort((a, b) => a[0] - b[0]);
  for (const [, i] of said) {
    if (basis.length === n - range.length) break;
    const unit = new Float64Array(n);
    unit[i] = 1;
    take(unit, basis, [...range, ...basis], 1e-4);
  }
  return basis;
}

// Stiffness of a cable or a stop, in units of EI/L, above which it counts as one that does not yield.
const RIGID = 1e4;

// Eigenvalues of the second variation over the admissible variations, ascending: docs/theory.md, section 9.
// jacobian: entry (i, j) as a function; allowed: free and held unknowns, and the energy unit of each free one.
function secondVariation(jacobian, allowed) {
  const { free, held, units } = allowed;
  const largest = Math.max(...units, 0);
  const roots = units.map((unit) => Math.sqrt(unit / largest));
  const hessian = free.map((i, p) => free.map((j, q) => (roots[p] * jacobian(i, j)) / roots[q]));
  const constraints = [];
  for (const k of held) {
    const row = free.map((j, q) => jacobian(k, j) / roots[q]);
    const pull = free.map((i, p) => roots[p] * jacobian(i, k));
    const own = jacobian(k, k);
    const sizes = Math.hypot(...free.map((j) => jacobian(k, j))) * Math.hypot(...free.map((i) => jacobian(i, k)));
    // A cable that is slack, or that stretches, and an elastic stop follow the variations; what is stiffer is held.
    if (own !== 0 && sizes <= RIGID * Math.abs(own)) {
      for (let p = 0; p < free.length; p++) for (let q = 0; q < free.length; q++) hessian[p][q] -= (pull[p] * row[q]) / own;
    } else constraints.push(row);
  }
  const basis = nullSpace(constraints, free.length);
  const images = basis.map((vector) => hessian.map((row) => row.reduce((sum, value, i) => sum + value * vector[i], 0)));
  const reduced = basis.map((vector) => images.map((image) => image.reduce((sum, value, i) => sum + value * vector[i], 0)));
  const symmetric = reduced.map((row, i) => row.map((value, j) => (value + reduced[j][i]) / 2));
  return eigen(symmetric).values.sort((a, b) => a - b);
}
