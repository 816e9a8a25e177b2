// Block 6: three joints that bring a point to a point. This file: three revolute joints, and what the other cases share.
//
// p = J1 A J2 B J3 w, with constant or known frames A, B and points w (beyond joint 3) and p (seen from before joint 1).
// g(q3) = B J3 w is affine in (c3, s3). With (X, Y) = the turn by q2 of (g1, g2), two components of the equation are free of q1 and
// linear in X and Y; X² + Y² = g1² + g2² is left for q3 (Pieper 1968). Axes that are parallel or intersect split it into blocks 1, 2, 4.
// A loop run backwards is the same problem with other constants, so only one of two mirrored cases is written here.

/// A function k0 + kc c + ks s of the point (c, s) of the circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// The constant.
    pub k0: Real,
    /// The factor of c.
    pub kc: Real,
    /// The factor of s.
    pub ks: Real,
}

impl Affine {
    /// The value at (c, s).
    #[inline]
    fn at(&self, c: Real, s: Real) -> Real {
        self.k0 + self.kc * c + self.ks * s
    }

    /// x self + y other + z.
    #[inline]
    fn combined(&self, x: Real, other: &Affine, y: Real, z: Real) -> Affine {
        Affine { k0: x * self.k0 + y * other.k0 + z, kc: x * self.kc + y * other.kc, ks: x * self.ks + y * other.ks }
    }

    /// The sum of the absolute coefficients.
    #[inline]
    fn size(&self) -> Real {
        self.k0.abs() + self.kc.abs() + self.ks.abs()
    }

    /// Adds `factor` times the square to a trigonometric polynomial of degree 2.
    #[inline]
    fn add_square(&self, factor: Real, a: &mut [Real; 3], b: &mut [Real; 3]) {
        let Affine { k0, kc, ks } = *self;
        a[0] += factor * (k0 * k0 + 0.5 * (kc * kc + ks * ks));
        a[1] += factor * 2.0 * k0 * kc;
        b[1] += factor * 2.0 * k0 * ks;
        a[2] += factor * 0.5 * (kc - ks) * (kc + ks);
        b[2] += factor * kc * ks;
    }
}

/// The points of the circle at which U² + V² = W, W = w0² - w1² + w2 affine where given so: roots of block R with D = 2.
/// `noise` is relative to the largest of the terms.
fn squares(u: &Affine, v: &Affine, minus: &[(Real, Affine)], linear: &Affine) -> CircleRoots<6> {
    let (mut a, mut b) = ([0.0; 3], [0.0; 3]);
    u.add_square(1.0, &mut a, &mut b);
    v.add_square(1.0, &mut a, &mut b);
    let mut size = u.size() * u.size() + v.size() * v.size() + linear.size();
    for (factor, w) in minus {
        w.add_square(-factor, &mut a, &mut b);
        size += factor.abs() * w.size() * w.size();
    }
    a[0] -= linear.k0;
    a[1] -= linear.kc;
    b[1] -= linear.ks;
    circle_roots(&a, &b, ROUNDING * size, 0.25 * ROUNDING * size, |points| {
        points.map(|[c, s]| {
            let (u, v) = (u.at(c, s), v.at(c, s));
            let mut value = u * u + v * v - linear.at(c, s);
            for (factor, w) in minus {
                let w = w.at(c, s);
                value -= factor * w * w;
            }
            value
        })
    })
}

/// The sum of all lengths of a problem: what rounding errors of lengths are measured by.
#[inline]
fn reach(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Real {
    let sum = |v: Vector| v[0].abs() + v[1].abs() + v[2].abs();
    extent(a) + extent(b) + sum(w) + sum(p)
}

/// The components of B Rz(q3) w as functions of (c3, s3).
#[inline]
fn point_of_third(b: &Frame, w: Vector) -> [Affine; 3] {
    let row = |r: &[Real; 4]| Affine { k0: r[3] + r[2] * w[2], kc: r[0] * w[0] + r[1] * w[1], ks: r[1] * w[0] - r[0] * w[1] };
    [row(&b[0]), row(&b[1]), row(&b[2])]
}

/// |B Rz(q3) w|², which is linear in (c3, s3).
#[inline]
fn square_of_third(b: &Frame, w: Vector) -> Affine {
    let (t, m) = (column(b, 3), rotate_back(b, column(b, 3)));
    Affine {
        k0: dot(t, t) + dot(w, w) + 2.0 * m[2] * w[2],
        kc: 2.0 * (m[0] * w[0] + m[1] * w[1]),
        ks: 2.0 * (m[1] * w[0] - m[0] * w[1]),
    }
}

/// How far rounding may have moved the angle between two links, rad; of two postures that meet `double` says enough.
#[inline]
fn error_apart(links: &TwoLinks) -> Real {
    if links.double {
        0.0
    } else {
        links.error
    }
}

/// Axes 2 and 3 parallel, B = Tz(d) Tx(a) Rx(0 or pi): q2 and q3 from the components X, Y across axis 2. For each posture of block 4: q2, q3,
/// its sign, (`double`, `error`) and what is free (bits 1 and 2).
#[inline]
fn elbow(b: &Frame, w: Vector, [x, y]: [Real; 2], noise: Real, doubt: Real, mut found: impl FnMut([Real; 2], [Real; 2], u16, (bool, Real), u32)) -> Real {
    let (l1, l2) = (b[0][3].abs(), length_on_axis(w[0], w[1]));
    // A negative length is a positive one turned by pi.
    let sign = if b[0][3] < 0.0 { -1.0 } else { 1.0 };
    let links = two_links(l1, l2, [x, y], noise, doubt);
    let free = if links.shoulder_free { 2 } else { 0 } | if links.elbow_free { 4 } else { 0 };
    let error = error_apart(&links);
    // Rz(q3) w stands at the elbow's angle, seen through Rx(0 or pi).
    let [wx, wy] = direction([w[0], w[1]], l2);
    for (i, ([c, s], [ce, se])) in links.shoulder.iter().zip(&links.elbow).enumerate().take(links.count) {
        let (x, y) = (sign * ce, sign * b[1][1] * se);
        let along = |x: Real, y: Real| plus_product(plus_product(-0.0, wx, x), wy, y);
        let q3 = [along(x, y), along(y, -x)];
        found([sign * c, sign * s], q3, i as u16, (links.double, error), free);
    }
    links.miss
}

/// Block 6, axes 2 and 3 parallel: p = Rz(q1) A Rz(q2) B Rz(q3) w with B = Tz(d) Tx(a) Rx(0 or pi).
///
/// The component along axis 2 is constant: block 1 gives q1 (shoulder), block 4 q3 and q2 (elbow). At most 4 solutions; `signs`: bit 0
/// shoulder, bit 1 elbow.
/// p on axis 1 with everything along axis 2 met: q1 free. Elbow folded onto the shoulder: q2 free. w on axis 3: q3 free.
pub fn regional_elbow(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let noise = ROUNDING * reach(a, b, w, p);
    let k = column(a, 2);
    let along = plus_product(b[2][3] + b[2][2] * w[2] + dot(k, column(a, 3)), -k[2], p[2]);
    let across = [dot_constant([k[0], k[1], 0.0], p), dot_constant([-k[1], k[0], 0.0], p)];
    let line = line_and_circle(across[0], across[1], along, noise, 0.0);
    found.missed(line.miss);
    let doubt = line.error * length(p[0], p[1]);
    for (sign, q1) in points(&line) {
        let v = minus(turn_vector(q1[0], -q1[1], p), column(a, 3));
        let (x, y) = (dot_constant(column(a, 0), v), dot_constant(column(a, 1), v));
        let mut add = |q2, q3, elbow: u16, (double, error), free| {
            let free = free | u32::from(line.free);
            let (double, error) = (line.double || double, line.error + error);
            found.add(Branch { joints: [q1, q2, q3], signs: sign | elbow << 1, double, error, free });
        };
        let miss = elbow(b, w, [x, y], noise, doubt, &mut add);
        found.missed(miss);
    }
    found
}

/// Block 6, axes 1 and 2 intersecting: p = Rz(q1) A Rz(q2) B Rz(q3) w with A = Tz(d) Rx(alpha), sin alpha not 0.
///
/// |p - d e3| = |B Rz(q3) w|: block 1 gives q3; the height gives q2 by block 1; q1 by block 2. At most 4 solutions; `signs`: bit 0 q3,
/// bit 1 q2.
/// p on axis 1: q1 free. B Rz(q3) w on axis 2: q2 free.
pub fn regional_crossing(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let reach = reach(a, b, w, p);
    let noise = ROUNDING * reach;
    let g = point_of_third(b, w);
    let square = square_of_third(b, w);
    let v = minus(p, column(a, 3));
    let line = line_and_circle(square.kc, square.ks, dot(v, v) - square.k0, noise * reach, 0.0);
    // The miss of squared lengths, as a length.
    found.missed(line.miss / reach);
    for (first, q3) in points(&line) {
        let [x, y, z] = [g[0].at(q3[0], q3[1]), g[1].at(q3[0], q3[1]), g[2].at(q3[0], q3[1])];
        let height = line_and_circle(a[2][1] * y, a[2][1] * x, v[2] - a[2][2] * z, noise, line.error * reach);
        found.missed(height.miss);
        for (second, q2) in points(&height) {
            let reached = transform(a, turn_vector(q2[0], q2[1], [x, y, z]));
            let last = turn([reached[0], reached[1]], [p[0], p[1]], noise);
            found.add(Branch {
                joints: [last.value, q2, q3],
                signs: first | second << 1,
                double: line.double || height.double,
                error: line.error + height.error,
                free: u32::from(last.free) | u32::from(height.free) << 1 | u32::from(line.free) << 2,
            });
        }
    }
    found
}

/// What `by_elimination` finds for one q3.
struct Eliminated {
    q2: [Real; 2],
    q3: [Real; 2],
    /// (X, Y, g3): the point after joint 2, before A.
    point: Vector,
    index: u16,
    double: bool,
    error: Real,
    free: u32,
}

/// q3 and q2 from two equations m·(X, Y, g3) = m0, r·(X, Y, g3) = r0, where (X, Y) is the turn of (g1, g2) by q2, g = B Rz(q3) w, and m0 may
/// depend on |g|²: m0 - |g|² half.
///
/// U = r2 N1 - m2 N2 and V = m1 N2 - r1 N1 are X and Y times the determinant of the two rows: U² + V² = determinant² (|g|² - g3²).
fn by_elimination(
    (m, m0): (Vector, Real),
    half: Real,
    (r, r0): (Vector, Real),
    (b, w): (&Frame, Vector),
    noise: Real,
    mut found: impl FnMut(Eliminated),
) -> (bool, bool) {
    let g = point_of_third(b, w);
    let square = square_of_third(b, w);
    let n1 = g[2].combined(-m[2], &square, -half, m0);
    let n2 = g[2].combined(-r[2], &square, 0.0, r0);
    let (u, v) = (n1.combined(r[1], &n2, -m[1], 0.0), n2.combined(m[0], &n1, -r[0], 0.0));
    let determinant = m[0] * r[1] - m[1] * r[0];
    let d2 = determinant * determinant;
    let roots = squares(&u, &v, &[(-d2, g[2])], &square.combined(d2, &square, 0.0, 0.0));
    for (i, root) in roots.all.iter().enumerate().take(roots.count) {
        let (c, s) = (root.c, root.s);
        let [x, y, z] = [g[0].at(c, s), g[1].at(c, s), g[2].at(c, s)];
        // The directions are enough: the lengths agree by the choice of q3.
        let q2 = turn([x, y], [u.at(c, s) / determinant, v.at(c, s) / determinant], noise);
        let point = turn_vector(q2.value[0], q2.value[1], [x, y, z]);
        let free = u32::from(q2.free) << 1;
        // Lengths that disagree are an error of q3 that the determinant magnified.
        let error = root.error + q2.miss / (length(x, y) + noise);
        let (index, double) = (i as u16, root.double);
        found(Eliminated { q2: q2.value, q3: [c, s], point, index, double, error, free });
    }
    (roots.free, roots.near && roots.count == 0)
}

/// Block 6, no particular axes: p = Rz(q1) A Rz(q2) B Rz(q3) w for any frames A, B whose axes 1 and 2 neither are parallel nor intersect.
///
/// The squared length |p|² = |tA|² + |g|² + 2 (RA' tA)·(X, Y, g3) and the height p_z = tA_z + e3' RA (X, Y, g3) are free of q1 (Pieper's
/// F1 to F4); `by_elimination` gives q3 and q2, block 2 q1. At most 4 solutions; `signs`: the number of q3's root, anticlockwise from 0.
/// The point on axis 2: q2 free. p on axis 1: q1 free. The equation in q3 empty: q3 free, without a value.
/// Axes 1 and 2 that nearly are parallel or intersect cost digits: as many as their offset times the sine of their angle is below 1.
pub fn regional_general(a: &Frame, b: &Frame, w: Vector, p: Vector) -> Branches<3, 4> {
    let mut found = Branches::new();
    let noise = ROUNDING * reach(a, b, w, p);
    let t = column(a, 3);
    let first = (rotate_back(a, t), 0.5 * (dot(p, p) - dot(t, t)));
    let second = ([a[2][0], a[2][1], a[2][2]], p[2] - t[2]);
    let (free, near) = by_elimination(first, 0.5, second, (b, w), noise, |e| {
        let reached = transform(a, e.point);
        let q1 = turn([reached[0], reached[1]], [p[0], p[1]], noise);
        let free = e.free | u32::from(q1.free);
        found.add(Branch { joints: [q1.value, e.q2, e.q3], signs: e.index, double: e.double, error: e.error, free });
    });
    found.near |= near;
    if free {
        found.add(Branch { joints: [[1.0, 0.0]; 3], signs: 0, double: false, error: 0.0, free: 7 });
    }
    found
}
