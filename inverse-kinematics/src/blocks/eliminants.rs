// Block 8: the equations of six joints of a general arm from which one joint is missing, and the determinant of their coefficients.
//
// The loop is arranged as (1 2 | 3 | 4 5 | 6). Axis 6, as a point p and a direction l, seen from before joint 3, does not feel q6; it is a
// function of q3, q4, q5 one way round and of q1, q2 the other. Of p, l, p × l, (p·p) l - 2 (p·l) p, p·p and p·l, 14 numbers, each side is
// bilinear: (1, c4, s4) ⊗ (1, c5, s5), turned by Rz(q3), and (1, c1, s1) ⊗ (1, c2, s2) (Raghavan, Roth 1993). The eight monomials of q1 and q2 that
// are not constant are eliminated; six equations in the nine monomials of q4 and q5 are left, with coefficients linear in (c3, s3).
// In x = tan(q/2) of q4 and q5, and with copies multiplied by x4, they are twelve in twelve monomials, M(q3): the determinant of M is a
// trigonometric polynomial of degree 8 in q3 whose real roots are looked for on the circle; no tan(q3/2), no eigenvalues, and the orders
// above 8, which should vanish, measure the rounding.

/// q4 is measured from here (rad, or the arm's length): so no posture that people build has x4 = 0, where the kernel's middle part vanishes.
const SHIFT: Real = 0.4636;

/// cos and sin of [`SHIFT`].
#[inline]
fn shift(prismatic: bool, length: Real) -> [Real; 2] {
    if prismatic {
        [SHIFT * length, 0.0]
    } else {
        let (c, s) = small_turn(SHIFT);
        [c, s]
    }
}

/// The 14 numbers of an axis.
fn line_of_axis(f: &Frame) -> [Real; 14] {
    let (p, l) = (column(f, 3), column(f, 2));
    let m = cross(p, l);
    let (pp, pl) = (dot(p, p), dot(p, l));
    let w = [pp * l[0] - 2.0 * pl * p[0], pp * l[1] - 2.0 * pl * p[1], pp * l[2] - 2.0 * pl * p[2]];
    [p[0], p[1], p[2], l[0], l[1], l[2], m[0], m[1], m[2], w[0], w[1], w[2], pp, pl]
}

/// Three values of a joint, enough for the three coefficients of (1, c, s) or (1, q, q²).
#[inline]
fn three_values(prismatic: bool) -> [[Real; 2]; 3] {
    const H: Real = 0.866025403784438646763723170752936183;
    if prismatic {
        [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0]]
    } else {
        [[1.0, 0.0], [-0.5, H], [-0.5, -H]]
    }
}

/// The coefficients from the three values.
#[inline]
fn coefficients(prismatic: bool, [x, y, z]: [Real; 3]) -> [Real; 3] {
    const THIRD: Real = 1.0 / 3.0;
    const OVER_ROOT_3: Real = 0.577350269189625764509148780501957456;
    if prismatic {
        [x, 0.5 * (y - z), 0.5 * (y + z) - x]
    } else {
        [(x + y + z) * THIRD, (2.0 * x - y - z) * THIRD, (y - z) * OVER_ROOT_3]
    }
}

/// The coefficients of a bilinear function of two joints, by nine of its values: those of joint a times those of joint b, a first.
fn bilinear(a: bool, b: bool, f: impl Fn([Real; 2], [Real; 2]) -> Frame) -> [[Real; 9]; 14] {
    let mut values = [[[0.0; 14]; 3]; 3];
    for (row, qa) in values.iter_mut().zip(three_values(a)) {
        for (value, qb) in row.iter_mut().zip(three_values(b)) {
            *value = line_of_axis(&f(qa, qb));
        }
    }
    let mut result = [[0.0; 9]; 14];
    for (k, result) in result.iter_mut().enumerate() {
        let [x, y, z] = &values;
        let by_b = |row: &[[Real; 14]; 3]| coefficients(b, [row[0][k], row[1][k], row[2][k]]);
        let (x, y, z) = (by_b(x), by_b(y), by_b(z));
        for j in 0..3 {
            let by_a = coefficients(a, [x[j], y[j], z[j]]);
            for i in 0..3 {
                result[3 * i + j] = by_a[i];
            }
        }
    }
    result
}

/// The six equations after q1 and q2 are eliminated, and what gives q1 and q2 back.
struct Eliminants {
    /// E0, Ec, Es: coefficients by powers x4^i x5^j at 3 i + j.
    e: [[[Real; 9]; 6]; 3],
    /// The eight eliminated rows: their triangle, then constants, factors of c3 and of s3 of the monomials of q4 and q5.
    rows: [[Real; 35]; 8],
    /// Which monomial each column of the triangle belongs to.
    columns: [usize; 8],
    /// How many rows of the triangle hold something.
    rank: usize,
}

/// A revolute joint's coefficients of (1, c, s) turned into those of 1, x, x² after multiplication with 1 + x²; those of a prismatic joint stay.
#[inline]
fn to_powers(prismatic: bool, [k, c, s]: [Real; 3]) -> [Real; 3] {
    if prismatic {
        [k, c, s]
    } else {
        [k + c, 2.0 * s, k - c]
    }
}

impl Eliminants {
    fn new(links: &[Frame; 6], prismatic: &[bool; 6], length: Real) -> Self {
        let [l0, l1, l2, l3, l4, l5] = links;
        let [p1, p2, _, p4, p5, _] = *prismatic;
        let l2 = compose(l2, &joint_then(p4, shift(p4, length), &IDENTITY));
        let left = bilinear(p4, p5, |q4, q5| compose(&l2, &joint_then(p4, q4, &compose(l3, &joint_then(p5, q5, l4)))));
        let (i0, i1, i5) = (inverse(l0), inverse(l1), inverse(l5));
        let back = |prismatic: bool, [c, s]: [Real; 2]| if prismatic { [-c, 0.0] } else { [c, -s] };
        let right = bilinear(p1, p2, |q1, q2| {
            compose(&i1, &joint_then(p2, back(p2, q2), &compose(&i0, &joint_then(p1, back(p1, q1), &i5))))
        });
        let mut a = [[0.0; 35]; 14];
        for j in 0..9 {
            // Of the four vectors the components across axis 3 are turned by Rz(q3), the others stay.
            for v in 0..4 {
                let (x, y) = (left[3 * v][j], left[3 * v + 1][j]);
                (a[3 * v][17 + j], a[3 * v][26 + j]) = (x, -y);
                (a[3 * v + 1][17 + j], a[3 * v + 1][26 + j]) = (y, x);
                a[3 * v + 2][8 + j] = left[3 * v + 2][j];
            }
            (a[12][8 + j], a[13][8 + j]) = (left[12][j], left[13][j]);
        }
        for (row, right) in a.iter_mut().zip(&right) {
            let [constant, rest @ ..] = right;
            row[..8].copy_from_slice(rest);
            row[8] -= constant;
            let square = row.iter().fold(0.0, |sum, x| sum + x * x);
            let over = inverse_sqrt(square);
            for x in row.iter_mut() {
                *x *= over;
            }
        }
        let (columns, rank) = eliminate(&mut a);
        let mut e = [[[0.0; 9]; 6]; 3];
        for (block, e) in e.iter_mut().enumerate() {
            for (e, row) in e.iter_mut().zip(&a[8..]) {
                let mut by_5 = [[0.0; 3]; 3];
                for (i, by_5) in by_5.iter_mut().enumerate() {
                    let at = 8 + 9 * block + 3 * i;
                    *by_5 = to_powers(p5, [row[at], row[at + 1], row[at + 2]]);
                }
                for j in 0..3 {
                    let by_4 = to_powers(p4, [by_5[0][j], by_5[1][j], by_5[2][j]]);
                    for i in 0..3 {
                        e[3 * i + j] = by_4[i];
                    }
                }
            }
        }
        let mut rows = [[0.0; 35]; 8];
        rows.copy_from_slice(&a[..8]);
        Eliminants { e, rows, columns, rank }
    }

    /// The six equations at points (c3, s3), side by side.
    fn at<const L: usize>(&self, points: &[[Real; 2]; L]) -> [[[Real; L]; 9]; 6] {
        let mut e = [[[0.0; L]; 9]; 6];
        let [e0, ec, es] = &self.e;
        for i in 0..6 {
            for j in 0..9 {
                for (x, [c, s]) in e[i][j].iter_mut().zip(points) {
                    *x = e0[i][j] + c * ec[i][j] + s * es[i][j];
                }
            }
        }
        e
    }
}

/// Orthogonal elimination of the first eight columns with column pivots (Householder). Returns the order of columns and the rank.
fn eliminate(a: &mut [[Real; 35]; 14]) -> ([usize; 8], usize) {
    let mut columns = [0, 1, 2, 3, 4, 5, 6, 7];
    let mut rank = 0;
    let mut first: Real = 0.0;
    for k in 0..8 {
        let mut squares = [0.0; 8];
        for row in a.iter().skip(k) {
            for (square, x) in squares.iter_mut().zip(row) {
                *square += x * x;
            }
        }
        let mut pivot = k;
        for j in k + 1..8 {
            if squares[j] > squares[pivot] {
                pivot = j;
            }
        }
        let square = squares[if pivot < 8 { pivot } else { k }];
        if k == 0 {
            first = square;
        }
        if !(square > ROUNDING * ROUNDING * first) {
            break;
        }
        rank = k + 1;
        if pivot > k && pivot < 8 {
            columns.swap(k, pivot);
            for row in a.iter_mut() {
                row.swap(k, pivot);
            }
        }
        let norm = sqrt(square);
        let diagonal = a[k][k];
        let b = if diagonal > 0.0 { -norm } else { norm };
        let over = 1.0 / (square - diagonal * b);
        a[k][k] = diagonal - b;
        let mut sums = [0.0; 35];
        for row in a.iter().skip(k) {
            for j in 0..35 {
                sums[j] += row[k] * row[j];
            }
        }
        for row in a.iter_mut().skip(k) {
            let factor = row[k] * over;
            for j in k + 1..35 {
                row[j] -= factor * sums[j];
            }
        }
        a[k][k] = b;
        for row in a.iter_mut().skip(k + 1) {
            row[k] = 0.0;
        }
    }
    (columns, rank)
}

/// One reflection (Householder) that clears column k below row k of matrices side by side; the pivots multiply `product`. What it clears is
/// not written, and nobody reads it.
#[inline]
fn reflect<const L: usize, const C: usize>(m: &mut [[[Real; L]; C]; 6], k: usize, product: &mut [Real; L]) {
    if k >= 6 || k >= C {
        return;
    }
    let mut squares = [0.0; L];
    for row in m.iter().skip(k) {
        for l in 0..L {
            squares[l] += row[k][l] * row[k][l];
        }
    }
    let mut over = [0.0; L];
    for l in 0..L {
        let diagonal = m[k][k][l];
        let norm = squares[l] * inverse_sqrt(squares[l]);
        let b = if diagonal > 0.0 { -norm } else { norm };
        product[l] *= -b;
        over[l] = 1.0 / (squares[l] - diagonal * b + Real::MIN_POSITIVE);
        m[k][k][l] = diagonal - b;
    }
    for j in k + 1..C {
        let mut sums = [0.0; L];
        for row in m.iter().skip(k) {
            for l in 0..L {
                sums[l] += row[k][l] * row[j][l];
            }
        }
        for l in 0..L {
            sums[l] *= over[l];
        }
        for row in m.iter_mut().skip(k) {
            for l in 0..L {
                row[j][l] -= row[k][l] * sums[l];
            }
        }
    }
}

/// The determinant of M reduced to 6 x 6: M = [E 0; 0 E] with E = [A B C] in blocks of three columns loses block column 1 by a triangular
/// decomposition of A and block column 4 by one of C. Returns the 6 x 6 matrix, in the monomials x4 and x4² times 1, x5, x5², and the product of the
/// determinants of the two triangles; times that of the matrix it is det M up to a sign that is always the same.
#[inline]
fn reduced<const L: usize>(e: &[[[Real; L]; 9]; 6]) -> ([[[Real; L]; 6]; 6], [Real; L]) {
    let mut product = [1.0; L];
    let mut m = [[[0.0; L]; 6]; 6];
    let mut upper = *e;
    let mut lower = *e;
    for row in &mut lower {
        row.rotate_right(3);
    }
    for k in 0..3 {
        reflect(&mut upper, k, &mut product);
        reflect(&mut lower, k, &mut product);
    }
    for i in 0..3 {
        m[i].copy_from_slice(&upper[i + 3][3..]);
        m[i + 3].copy_from_slice(&lower[i + 3][3..]);
    }
    (m, product)
}

/// det M at points side by side, up to a sign that is always the same.
#[inline]
fn determinants<const L: usize>(e: &[[[Real; L]; 9]; 6]) -> [Real; L] {
    let (mut m, mut product) = reduced(e);
    for k in 0..5 {
        reflect(&mut m, k, &mut product);
    }
    for l in 0..L {
        product[l] *= m[5][5][l];
    }
    product
}

/// The kernel of a nearly singular 6 x 6 matrix by complete pivoting: one vector, or two where the last two pivots are small. Columns are
/// monomials x4^(1 + i) x5^j at 3 i + j.
fn kernel(m: &[[[Real; 1]; 6]; 6], pair: bool) -> ([[Real; 6]; 2], usize) {
    let mut flat = [[0.0; 6]; 6];
    for (flat, row) in flat.iter_mut().zip(m) {
        for (flat, [x]) in flat.iter_mut().zip(row) {
            *flat = *x;
        }
    }
    let mut m = flat;
    let mut columns = [0, 1, 2, 3, 4, 5];
    let mut pivots = [0.0; 6];
    for k in 0..5 {
        let (mut pi, mut pj, mut largest) = (k, k, -1.0);
        for i in k..6 {
            for j in k..6 {
                if m[i][j].abs() > largest {
                    (pi, pj, largest) = (i, j, m[i][j].abs());
                }
            }
        }
        if pi > k && pi < 6 {
            m.swap(k, pi);
        }
        if pj > k && pj < 6 {
            columns.swap(k, pj);
            for row in &mut m {
                row.swap(k, pj);
            }
        }
        pivots[k] = largest;
        let row = m[k];
        let over = if row[k] != 0.0 { 1.0 / row[k] } else { 0.0 };
        for below in m.iter_mut().skip(k + 1) {
            let factor = below[k] * over;
            for j in k..6 {
                below[j] -= factor * row[j];
            }
        }
    }
    // Two solutions nearly share q3 where the last but one pivot is small as well.
    // More than two where the one before is, and then no two are told apart.
    let pair = if pair { pivots[3] > CROWDED * pivots[0] } else { !(pivots[4] > SHARED * pivots[0]) };
    let mut vectors = [[0.0; 6]; 2];
    let count = if pair { 2 } else { 1 };
    for (n, vector) in vectors.iter_mut().enumerate().take(count) {
        let mut x = if pair && n == 0 { [0.0, 0.0, 0.0, 0.0, 1.0, 0.0] } else { [0.0, 0.0, 0.0, 0.0, 0.0, 1.0] };
        for k in (0..5).rev() {
            if k == 4 && pair {
                continue;
            }
            let mut sum = 0.0;
            // The bounds of j do not depend on k, so that the optimiser sees that no index is out of range.
            for j in 1..6 {
                if j > k {
                    sum -= m[k][j] * x[j];
                }
            }
            x[k] = if m[k][k] != 0.0 { sum / m[k][k] } else { 0.0 };
        }
        for (column, x) in columns.iter().zip(x) {
            if let Some(slot) = vector.get_mut(*column) {
                *slot = x;
            }
        }
    }
    (vectors, count)
}

/// Below this ratio of the last but one pivot to the first a kernel counts as two-dimensional.
const SHARED: Real = 1e-5;

/// The same of the pivot before at a root that stands for two.
const CROWDED: Real = if UNIT_ROUNDOFF < 1e-10 { 1e-5 } else { 1e-2 };

/// The members of the pencil alpha v + beta w that are products (x4, x4²) ⊗ (1, x5, x5²): the 2 x 2 minor with the largest coefficients
/// vanishes. None if its roots are not real.
fn products_in_pencil([v, w]: &[[Real; 6]; 2]) -> ([[Real; 6]; 2], usize) {
    let (mut best, mut size) = ([0.0; 3], -1.0);
    for (j, l) in [(0, 1), (0, 2), (1, 2)] {
        let q = [
            v[j] * v[3 + l] - v[l] * v[3 + j],
            v[j] * w[3 + l] + w[j] * v[3 + l] - v[l] * w[3 + j] - w[l] * v[3 + j],
            w[j] * w[3 + l] - w[l] * w[3 + j],
        ];
        let square = q[0] * q[0] + q[1] * q[1] + q[2] * q[2];
        if square > size {
            (best, size) = (q, square);
        }
    }
    // alpha² q0 + alpha beta q1 + beta² q2 = 0
    let q = best;
    let discriminant = q[1] * q[1] - 4.0 * q[0] * q[2];
    if !(discriminant >= -1e-9 * size) {
        return ([[0.0; 6]; 2], 0);
    }
    let root = sqrt(discriminant.max(0.0));
    let p = -0.5 * (q[1] + if q[1] > 0.0 { root } else { -root });
    let member = |alpha: Real, beta: Real| {
        let mut x = [0.0; 6];
        for i in 0..6 {
            x[i] = alpha * v[i] + beta * w[i];
        }
        x
    };
    ([member(p, q[0]), member(q[2], p)], 2)
}

/// The point (cos q, sin q) whose half tangent is y/x, or the length y/x.
#[inline]
fn of_ratio(prismatic: bool, x: Real, y: Real) -> [Real; 2] {
    if prismatic {
        [y / x, 0.0]
    } else {
        let over = 1.0 / (x * x + y * y);
        [(x - y) * (x + y) * over, 2.0 * x * y * over]
    }
}

/// The point of the circle in the direction of (c, s); (1, 0) if there is none.
#[inline]
fn onto_circle(c: Real, s: Real) -> [Real; 2] {
    let n = length(c, s);
    if n > 0.0 {
        [c / n, s / n]
    } else {
        [1.0, 0.0]
    }
}

impl Eliminants {
    /// All joints from q3 and a product (x4, x4²) ⊗ (1, x5, x5²); and by how much the equations beyond the six are not met, if there are any:
    /// with them more than rounding apart the root is one of the six equations alone.
    fn joints(
        &self,
        links: &[Frame; 6],
        prismatic: &[bool; 6],
        length: Real,
        q3: [Real; 2],
        v: &[Real; 6],
    ) -> ([[Real; 2]; 6], Real) {
        let [p1, p2, _, p4, p5, _] = *prismatic;
        let square = |j: usize| v.get(j).map_or(0.0, |x| x * x) + v.get(j + 3).map_or(0.0, |x| x * x);
        let (x4, y4) = if square(0) >= square(1) && square(0) >= square(2) {
            (v[0], v[3])
        } else if square(1) >= square(2) {
            (v[1], v[4])
        } else {
            (v[2], v[5])
        };
        let row = |i: usize| [v[i], v[i + 1], v[i + 2]];
        let (upper, lower) = (row(0), row(3));
        let [a, b, c] = if dot(upper, upper) >= dot(lower, lower) { upper } else { lower };
        let q5 = if a.abs() >= c.abs() { of_ratio(p5, a, b) } else { of_ratio(p5, b, c) };
        // Measured from the shift, as the equations do.
        let shifted = of_ratio(p4, x4, y4);
        let (f4, f5) = (
            if p4 { [1.0, shifted[0], shifted[0] * shifted[0]] } else { [1.0, shifted[0], shifted[1]] },
            if p5 { [1.0, q5[0], q5[0] * q5[0]] } else { [1.0, q5[0], q5[1]] },
        );
        let mut y = [0.0; 8];
        let mut x = [0.0; 8];
        let mut unmet: Real = 0.0;
        for k in (0..8).rev() {
            let row = &self.rows[k];
            let mut sum = 0.0;
            for (i, f4) in f4.iter().enumerate() {
                for (j, f5) in f5.iter().enumerate() {
                    let at = 8 + 3 * i + j;
                    sum += (row[at] + q3[0] * row[at + 9] + q3[1] * row[at + 18]) * f4 * f5;
                }
            }
            for j in k + 1..8 {
                sum -= row[j] * x[j];
            }
            if k < self.rank {
                x[k] = sum / row[k];
            } else {
                unmet = unmet.max(sum.abs());
            }
        }
        for (column, x) in self.columns.iter().zip(x) {
            if let Some(slot) = y.get_mut(*column) {
                *slot = x;
            }
        }
        // In order: those of joint 2, then joint 1 alone and with joint 2, first by c1 or q1, then by s1 or q1².
        let q1 = if p1 { [y[2], 0.0] } else { onto_circle(y[2], y[5]) };
        let q2 = if p2 { [y[0], 0.0] } else { onto_circle(y[0], y[1]) };
        let [c, s] = shift(p4, length);
        let q4 = if p4 { [shifted[0] + c, 0.0] } else { [shifted[0] * c - shifted[1] * s, shifted[1] * c + shifted[0] * s] };
        let [l0, l1, l2, l3, l4, l5] = links;
        let chain = joint_then(p4, q4, &compose(l3, &joint_then(p5, q5, l4)));
        let chain = joint_then(p2, q2, &compose(l1, &joint_then(false, q3, &compose(l2, &chain))));
        let chain = joint_then(p1, q1, &compose(l0, &chain));
        let rest = compose(&inverse(&chain), &inverse(l5));
        ([q1, q2, q3, q4, q5, onto_circle(rest[0][0], rest[1][0])], unmet)
    }
}
