/**
 * Small linear algebra: eigenvalues of symmetric matrices by Jacobi's rotations, determinants and systems by elimination, and what follows of a Jacobian
 * (manipulability, ellipsoids, condition).
 */

/** @typedef {number[][]} Matrix */

/** Eigenvalues of a symmetric matrix, largest first, and unit eigenvectors as columns. @param {Matrix} symmetric */
export function eigen(symmetric) {
    const n = symmetric.length;
    const a = symmetric.map((row) => row.slice());
    const v = identityOf(n);
    for (let sweep = 0; sweep < 60; sweep++) {
        let off = 0;
        for (let p = 0; p < n; p++) for (let q = p + 1; q < n; q++) off += a[p][q] * a[p][q];
        if (off === 0) break;
        for (let p = 0; p < n; p++) {
            for (let q = p + 1; q < n; q++) {
                if (a[p][q] === 0) continue;
                const theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const t = (theta < 0 ? -1 : 1) / (Math.abs(theta) + Math.sqrt(theta * theta + 1));
                const c = 1 / Math.sqrt(t * t + 1);
                const s = t * c;
                for (let k = 0; k < n; k++) {
                    const [x, y] = [a[k][p], a[k][q]];
                    a[k][p] = c * x - s * y;
                    a[k][q] = s * x + c * y;
                }
                for (let k = 0; k < n; k++) {
                    const [x, y] = [a[p][k], a[q][k]];
                    a[p][k] = c * x - s * y;
                    a[q][k] = s * x + c * y;
                }
                a[p][q] = 0;
                a[q][p] = 0;
                for (let k = 0; k < n; k++) {
                    const [x, y] = [v[k][p], v[k][q]];
                    v[k][p] = c * x - s * y;
                    v[k][q] = s * x + c * y;
                }
            }
        }
    }
    const order = a.map((_, i) => i).sort((i, j) => a[j][j] - a[i][i]);
    return { values: order.map((i) => a[i][i]), vectors: v.map((row) => order.map((i) => row[i])) };
}

/**
 * Brings a matrix, in place, to triangular form by elimination with the largest pivot; b, if given, goes along. The sign of the rows' order, 0 where
 * a pivot is 0.
 *
 * @param {Matrix} a @param {number[]} [b]
 */
function eliminate(a, b) {
    let sign = 1;
    for (let k = 0; k < a.length; k++) {
        let pivot = k;
        for (let i = k + 1; i < a.length; i++) if (Math.abs(a[i][k]) > Math.abs(a[pivot][k])) pivot = i;
        if (a[pivot][k] === 0) return 0;
        if (pivot !== k) {
            [a[pivot], a[k]] = [a[k], a[pivot]];
            if (b) [b[pivot], b[k]] = [b[k], b[pivot]];
            sign = -sign;
        }
        for (let i = k + 1; i < a.length; i++) {
            const factor = a[i][k] / a[k][k];
            for (let j = k; j < a.length; j++) a[i][j] -= factor * a[k][j];
            if (b) b[i] -= factor * b[k];
        }
    }
    return sign;
}

/** By elimination with the largest pivot. @param {Matrix} matrix */
export function determinant(matrix) {
    const a = matrix.map((row) => row.slice());
    const sign = eliminate(a);
    return sign === 0 ? 0 : a.reduce((product, row, k) => product * row[k], sign);
}

/** Solves A x = b in place; null where it cannot. @param {Matrix} a @param {number[]} b */
export function solve(a, b) {
    if (eliminate(a, b) === 0) return null;
    for (let k = b.length - 1; k >= 0; k--) {
        for (let j = k + 1; j < b.length; j++) b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
    }
    return b.some(Number.isNaN) ? null : b;
}

/** J J'. @param {Matrix} j */
export function gram(j) {
    return j.map((a) => j.map((b) => a.reduce((sum, x, k) => sum + x * b[k], 0)));
}

/**
 * Singular values of a matrix, largest first, and the left singular vectors that belong to them, by rotations that make its rows perpendicular
 * to each other (Hestenes, 1958): small values keep their digits, which eigenvalues of J J' do not. A value below what the rounding of the
 * entries can make is 0.
 *
 * @param {Matrix} j
 */
export function singular(j) {
    const rows = j.map((row) => row.slice());
    const left = identityOf(j.length);
    const turn = (all, p, q, c, s) => all[p].forEach((x, k) => ([all[p][k], all[q][k]] = [c * x - s * all[q][k], s * x + c * all[q][k]]));
    for (let sweep = 0; sweep < 60; sweep++) {
        let turned = false;
        for (let p = 0; p < rows.length; p++) {
            for (let q = p + 1; q < rows.length; q++) {
                const product = (a, b) => a.reduce((sum, x, k) => sum + x * b[k], 0);
                const [aa, bb, ab] = [product(rows[p], rows[p]), product(rows[q], rows[q]), product(rows[p], rows[q])];
                if (ab === 0 || Math.abs(ab) <= 1e-16 * Math.sqrt(aa * bb)) continue;
                turned = true;
                const zeta = (bb - aa) / (2 * ab);
                const t = (zeta < 0 ? -1 : 1) / (Math.abs(zeta) + Math.sqrt(1 + zeta * zeta));
                const c = 1 / Math.sqrt(1 + t * t);
                turn(rows, p, q, c, c * t);
                turn(left, p, q, c, c * t);
            }
        }
        if (!turned) break;
    }
    const lengths = rows.map((row) => Math.hypot(...row));
    const order = lengths.map((_, k) => k).sort((a, b) => lengths[b] - lengths[a]);
    const least = j.length * j[0].length * ROUNDING * lengths[order[0]];
    return { values: order.map((k) => (lengths[k] <= least ? 0 : lengths[k])), left: order.map((k) => left[k]) };
}

/** The spacing of floats at 1. */
export const ROUNDING = 2 ** -52;

/** w = sqrt(det(J J')) = the product of the singular values; 0 for more rows than columns. @param {Matrix} j */
export function manipulability(j) {
    return j.length > j[0].length ? 0 : singular(j).values.reduce((product, s) => product * s, 1);
}

/** The largest singular value over the smallest; infinite at a singular posture. @param {Matrix} j */
export function condition(j) {
    if (j.length > j[0].length) return Infinity;
    const { values } = singular(j);
    return values[0] / values[values.length - 1];
}

/**
 * The combinations of the rows that no rates move, u' J = 0: a basis of them in echelon form, each with 1 at its largest entry; where there is
 * none, the one that they move least. Also by how much rates of norm 1 move it at most.
 *
 * @param {Matrix} j @returns {{most: number, of: number[][]}}
 */
export function lost(j) {
    const { values, left } = singular(j);
    const least = values[values.length - 1];
    const of = left.filter((_, k) => (least > 0 ? k === left.length - 1 : values[k] === 0));
    let most = least;
    for (let k = 0; k < of.length; k++) {
        // The largest entry of those that are left: nothing that rounding made becomes a pivot.
        let [row, column] = [k, 0];
        for (let i = k; i < of.length; i++) of[i].forEach((x, c) => Math.abs(x) > Math.abs(of[row][column]) + 1e-9 && ([row, column] = [i, c]));
        [of[k], of[row]] = [of[row], of[k]];
        const pivot = of[k][column];
        of[k] = of[k].map((x) => x / pivot);
        of.forEach((other, i) => i !== k && (of[i] = other.map((x, c) => x - other[column] * of[k][c])));
        most /= Math.abs(pivot);
    }
    return { most, of: of.map((row) => row.map((x) => (Math.abs(x) < 1e-9 ? 0 : Math.abs(x - 1) < 1e-9 ? 1 : x))) };
}

/** @param {number} n @returns {Matrix} */
function identityOf(n) {
    return Array.from({ length: n }, (_, i) => Array.from({ length: n }, (_, j) => (i === j ? 1 : 0)));
}

/**
 * The outline of the ellipsoid x' A^-1 x = 1 in an orthographic view: the ellipse of P A P', P the two directions of the screen. Its
 * semi-axes and the angle of the first.
 *
 * @param {Matrix} a symmetric, 3 by 3
 * @param {number[]} right
 * @param {number[]} up
 */
export function outline(a, right, up) {
    const form = (u, v) => u.reduce((sum, x, i) => sum + x * a[i].reduce((inner, y, j) => inner + y * v[j], 0), 0);
    const [xx, xy, yy] = [form(right, right), form(right, up), form(up, up)];
    const { values, vectors } = eigen([
        [xx, xy],
        [xy, yy],
    ]);
    const semi = values.map((value) => Math.sqrt(Math.max(0, value)));
    return { semi, angle: Math.atan2(vectors[1][0], vectors[0][0]) };
}
