// Small systems of linear equations, and products of vectors.

/** Complex symmetric system with a positive definite real part, solved without pivots. */
export class Symmetric {
  /** @param {number} n */
  constructor(n) {
    this.n = n;
    this.re = new Float64Array(n * n);
    this.im = new Float64Array(n * n);
    this.right = { re: new Float64Array(n), im: new Float64Array(n) };
  }

  /** Sets entry i, j of the lower triangle. @param {number} i @param {number} j @param {number} re @param {number} im */
  set(i, j, re, im) {
    this.re[i * this.n + j] = re;
    this.im[i * this.n + j] = im;
  }

  /** @param {number} i @param {number} re @param {number} im */
  ask(i, re, im) {
    this.right.re[i] = re;
    this.right.im[i] = im;
  }

  /** Solves the system by L D L', and overwrites it. */
  solved() {
    const { n, re, im, right } = this;
    const rowRe = new Float64Array(n);
    const rowIm = new Float64Array(n);
    for (let i = 0; i < n; i++) {
      const own = i * n;
      for (let j = 0; j < i; j++) {
        let a = re[own + j];
        let b = im[own + j];
        const other = j * n;
        for (let k = 0; k < j; k++) {
          a -= rowRe[k] * re[other + k] - rowIm[k] * im[other + k];
          b -= rowRe[k] * im[other + k] + rowIm[k] * re[other + k];
        }
        rowRe[j] = a;
        rowIm[j] = b;
      }
      for (let j = 0; j < i; j++) {
        const d = re[j * n + j] ** 2 + im[j * n + j] ** 2;
        const l = (rowRe[j] * re[j * n + j] + rowIm[j] * im[j * n + j]) / d;
        const m = (rowIm[j] * re[j * n + j] - rowRe[j] * im[j * n + j]) / d;
        re[own + i] -= l * rowRe[j] - m * rowIm[j];
        im[own + i] -= l * rowIm[j] + m * rowRe[j];
        re[own + j] = l;
        im[own + j] = m;
        right.re[i] -= l * right.re[j] - m * right.im[j];
        right.im[i] -= l * right.im[j] + m * right.re[j];
      }
    }
    for (let i = n - 1; i >= 0; i--) {
      const d = re[i * n + i] ** 2 + im[i * n + i] ** 2;
      let a = (right.re[i] * re[i * n + i] + right.im[i] * im[i * n + i]) / d;
      let b = (right.im[i] * re[i * n + i] - right.re[i] * im[i * n + i]) / d;
      for (let k = i + 1; k < n; k++) {
        a -= re[k * n + i] * right.re[k] - im[k * n + i] * right.im[k];
        b -= re[k * n + i] * right.im[k] + im[k * n + i] * right.re[k];
      }
      right.re[i] = a;
      right.im[i] = b;
    }
    return right;
  }
}

/** Cholesky factor L of a real positive definite matrix, L L'. */
export class Cholesky {
  /** @param {Float64Array} K row after row @param {number} size of its rows @param {number} first row and column of the part that is factored */
  constructor(K, size, first) {
    const n = size - first;
    this.n = n;
    this.first = first;
    this.L = new Float64Array(n * n);
    const { L } = this;
    for (let i = 0; i < n; i++) {
      for (let j = 0; j <= i; j++) {
        let left = K[(i + first) * size + j + first];
        for (let k = 0; k < j; k++) left -= L[i * n + k] * L[j * n + k];
        L[i * n + j] = i === j ? Math.sqrt(left) : left / L[j * n + j];
      }
    }
  }

  /** Solves for the unknowns from `first` on, in place. @param {Float64Array} y */
  solve(y) {
    const { n, L, first } = this;
    for (let i = 0; i < n; i++) {
      let left = y[first + i];
      for (let k = 0; k < i; k++) left -= L[i * n + k] * y[first + k];
      y[first + i] = left / L[i * n + i];
    }
    for (let i = n - 1; i >= 0; i--) {
      const found = y[first + i] / L[i * n + i];
      y[first + i] = found;
      for (let k = 0; k < i; k++) y[first + k] -= L[i * n + k] * found;
    }
  }
}

/** @param {ArrayLike<number>} u @param {ArrayLike<number>} v */
export function dot(u, v) {
  let total = 0;
  for (let k = 0; k < u.length; k++) total += u[k] * v[k];
  return total;
}

/** Potentials of all coordinates from those of the terminals. @param {number[]} row @param {number} size */
export function padded(row, size) {
  const whole = new Float64Array(size);
  whole.set(row);
  return whole;
}

/** @param {Float64Array} M square @param {Float64Array} v */
export function times(M, v) {
  return v.map((_, row) => dot(M.subarray(row * v.length, (row + 1) * v.length), v));
}

/** Inverse of a small matrix, by Gauss and Jordan. @param {number[][]} given */
export function inverted(given) {
  const n = given.length;
  const A = given.map((row, i) => [...row, ...row.map((_, j) => Number(i === j))]);
  for (let i = 0; i < n; i++) {
    A[i] = A[i].map((value) => value / A[i][i]);
    for (let k = 0; k < n; k++) {
      if (k !== i) A[k] = A[k].map((value, j) => value - A[k][i] * A[i][j]);
    }
  }
  return A.map((row) => row.slice(n));
}
