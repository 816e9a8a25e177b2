// Block 7: six revolute joints, three neighbours of which have parallel axes.

/// One pair of points that [`two_circles`] finds.
#[derive(Clone, Copy)]
struct PairOfPoints {
    a: [Real; 2],
    b: [Real; 2],
    signs: u16,
    double: bool,
    a_free: bool,
    b_free: bool,
    /// How far rounding may have moved the two angles together, rad.
    error: Real,
}

/// What [`two_circles`] finds.
struct TwoCircles {
    count: usize,
    pairs: [PairOfPoints; 6],
    /// qa comes from the last equation, else qb.
    a_last: bool,
    /// By how much the last way without a solution missed.
    miss: Real,
    /// Rounding decides that there is none.
    near: bool,
}

impl TwoCircles {
    fn new(a_last: bool) -> Self {
        let none = PairOfPoints { a: [1.0, 0.0], b: [1.0, 0.0], signs: 0, double: false, a_free: false, b_free: false, error: 0.0 };
        TwoCircles { count: 0, pairs: [none; 6], a_last, miss: 0.0, near: false }
    }

    fn add(&mut self, pair: PairOfPoints) {
        if let Some(slot) = self.pairs.get_mut(self.count) {
            *slot = pair;
            self.count += 1;
        }
    }
}

/// The solutions of the pair of equations m1 (ca, sa)' + m2 (cb, sb)' = d on two circles; `sizes`: of the terms of either.
///
/// m2 singular: the combination of the equations that is free of b is block 1 in a, the other then block 1 in b; or the other way round.
/// Else the point of one circle is affine in that of the other, and on its circle: block R with D = 2.
#[inline(always)]
fn two_circles(m1: [[Real; 2]; 2], m2: [[Real; 2]; 2], d: [Real; 2], sizes: [Real; 2]) -> TwoCircles {
    let determinant = |m: [[Real; 2]; 2]| m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let square = |[x, y]: [Real; 2]| x * x + y * y;
    let (d1, d2) = (determinant(m1), determinant(m2));
    let noise = [ROUNDING * sizes[0], ROUNDING * sizes[1]];
    // Where the pose is in Lc, m2 is known at compile time, and whether this is so.
    if d2.abs() <= ROUNDING * (square(m2[0]) + square(m2[1])) {
        return one_circle_first(m1, m2, d, noise);
    }
    // Both equations in one unit.
    let weight = sizes[1] / sizes[0];
    let size = |m: [[Real; 2]; 2]| weight * weight * square(m[0]) + square(m[1]);
    if weight * d1.abs() <= ROUNDING * size(m1) {
        let mut found = one_circle_first(m2, m1, d, noise);
        found.a_last = true;
        for pair in &mut found.pairs {
            *pair = PairOfPoints { a: pair.b, b: pair.a, a_free: pair.b_free, b_free: pair.a_free, ..*pair };
        }
        return found;
    }
    // The matrix that is farther from singular is inverted.
    let swapped = d2.abs() * size(m1) > d1.abs() * size(m2);
    let mut found = TwoCircles::new(swapped);
    let (m, other, determinant) = if swapped { (m2, m1, d2) } else { (m1, m2, d1) };
    // determinant times the point on the one circle, affine in the point of the other.
    let row = |i: usize| Affine { k0: d[i], kc: -other[i][0], ks: -other[i][1] };
    let (n0, n1) = (row(0), row(1));
    let (u, v) = (n0.combined(m[1][1], &n1, -m[0][1], 0.0), n1.combined(m[0][0], &n0, -m[1][0], 0.0));
    let roots = squares(&u, &v, &[], &Affine { k0: determinant * determinant, kc: 0.0, ks: 0.0 });
    for (i, root) in roots.all.iter().enumerate().take(roots.count) {
        let y = [root.c, root.s];
        let x = turn([1.0, 0.0], [u.at(y[0], y[1]) / determinant, v.at(y[0], y[1]) / determinant], 0.0);
        // A length other than 1 is an error that the division magnified.
        let error = root.error + x.miss;
        let (a, b) = if swapped { (y, x.value) } else { (x.value, y) };
        found.add(PairOfPoints { a, b, signs: i as u16, double: root.double, a_free: false, b_free: false, error });
    }
    if roots.free {
        found.a_last = false;
        found.add(PairOfPoints { a: [1.0, 0.0], b: [1.0, 0.0], signs: 0, double: false, a_free: true, b_free: true, error: 0.0 });
    }
    found.near = roots.near && roots.count == 0;
    found
}

/// The same where m2 is singular.
#[inline(always)]
fn one_circle_first(m1: [[Real; 2]; 2], m2: [[Real; 2]; 2], d: [Real; 2], noise: [Real; 2]) -> TwoCircles {
    let mut found = TwoCircles::new(false);
    // The range of m2 is its larger column, which may have any length; across it the equations are free of b. Both are combinations of the
    // two equations by what is constant, and often 0.
    let (n0, n1) = (m2[0][0].abs() + m2[1][0].abs(), m2[0][1].abs() + m2[1][1].abs());
    let range = if n0 >= n1 { [m2[0][0] / n0, m2[1][0] / n0] } else { [m2[0][1] / n1, m2[1][1] / n1] };
    let [x, y] = if n0 + n1 > 0.0 { range } else { [1.0, 0.0] };
    let along = |u: Real, v: Real| plus_product(plus_product(-0.0, x, u), y, v);
    let across = |u: Real, v: Real| plus_product(plus_product(-0.0, x, v), -y, u);
    let (x_size, y_size) = (x.abs(), y.abs());
    let noise_across = plus_product(plus_product(-0.0, x_size, noise[1]), y_size, noise[0]);
    let noise_along = plus_product(plus_product(-0.0, x_size, noise[0]), y_size, noise[1]);
    let first = line_and_circle(across(m1[0][0], m1[1][0]), across(m1[0][1], m1[1][1]), across(d[0], d[1]), noise_across, 0.0);
    let (p, q) = (along(m1[0][0], m1[1][0]), along(m1[0][1], m1[1][1]));
    let ([bc, bs], doubt) = ([along(m2[0][0], m2[1][0]), along(m2[0][1], m2[1][1])], first.error * length(p, q));
    found.miss = first.miss;
    for (i, a) in points(&first) {
        let second = line_and_circle(bc, bs, along(d[0], d[1]) - (p * a[0] + q * a[1]), noise_along, doubt);
        found.miss = if second.count == 0 { second.miss } else { found.miss };
        for (j, b) in points(&second) {
            let double = first.double || second.double;
            let error = first.error + second.error;
            found.add(PairOfPoints { a, b, signs: i | j << 1, double, a_free: first.free, b_free: second.free, error });
        }
    }
    found
}

/// The angle q of the row v Rz(q) F whose third component has given it, mended where that component is nearly 1.
///
/// There it is a cosine, which leaves u/sine of q. The rest of the row is the sine itself, and `wanted` says how long it is:
/// d|rest|/dq = -(third/|rest|) d third/dq gives a step of Newton's.
#[inline]
fn mended(v: Vector, q: [Real; 2], f: &Frame, wanted: Real) -> [Real; 2] {
    if !(wanted < 0.125) {
        return q;
    }
    // d(v Rz(q))/dq = (v2, -v1, 0) for the turned v.
    let turned = turn_vector(q[0], -q[1], v);
    let (third, slope) = (dot(turned, column(f, 2)), turned[1] * f[0][2] - turned[0] * f[1][2]);
    let sine = length(dot(turned, column(f, 0)), dot(turned, column(f, 1)));
    let step = (sine - wanted) * sine / (third * slope);
    // A larger one is no error of rounding.
    if !(step.abs() < 0.125 * sine) {
        return q;
    }
    let (c, s) = small_turn(step);
    [c * q[0] - s * q[1], c * q[1] + s * q[0]]
}

/// How far qc may be off, rad, where axis c is nearly parallel to the three: the normal is `sine` long across it, and from both sides that differs by
/// `miss`. The angles that give it are found from cosines, which leave u/sine of it. A length that is least where it was looked for leaves the root
/// of its own error.
#[cold]
fn error_beside_parallel(sine: Real, miss: Real) -> Real {
    let over = 1.0 / (sine + UNIT_ROUNDOFF);
    0.25 * ROUNDING * over * over + sqrt(2.0 * miss * over)
}

/// Where qc is free: an angle that leaves the elbow within reach, (1, 0) if that does. The squared distance that two links have to reach is
/// k0 + kc c + ks s; the middle of what of it is within their reach is aimed at.
fn within_reach(place: &impl Fn([Real; 2]) -> [Real; 2], l1: Real, l2: Real) -> [Real; 2] {
    let square = |q: [Real; 2]| {
        let [x, y] = place(q);
        x * x + y * y
    };
    let (x, y, z) = (square([1.0, 0.0]), square([-1.0, 0.0]), square([0.0, 1.0]));
    let (inner, outer) = ((l1 - l2) * (l1 - l2), (l1 + l2) * (l1 + l2));
    if inner < x && x < outer {
        return [1.0, 0.0];
    }
    let (k0, kc) = (0.5 * (x + y), 0.5 * (x - y));
    let ks = z - k0;
    let r = length(kc, ks);
    let aim = 0.5 * (inner.max(k0 - r) + outer.min(k0 + r));
    let line = line_and_circle(kc, ks, aim - k0, 0.0, ROUNDING * (k0 + outer));
    let [first, _] = line.points;
    first
}

/// Block 7, three parallel axes: Ja La (J1 L1 J2 L2 J3) L3 Jb Lb Jc Lc = 1 with L1, L2 = Tz(d) Tx(a) Rx(0 or pi).
///
/// The bracket is a displacement M of the plane normal to its axes: its third row is (0, 0, ±1, h), constant. M L3 Jb Lb = La⁻¹ Ja⁻¹ Lc⁻¹ Jc⁻¹,
/// and of the third row of both sides Jc⁻¹ leaves the third component and the offset alone: two equations, linear in (ca, sa) and (cb, sb).
/// If axes b and c intersect (UR arms: the offset is free of qb) or are parallel, or axes a and c, each is block 1; else block R with D = 2
/// (`two_circles`). qc by block 2 from the rest of the row; M's displacement gives the elbow by block 4, its turn the last angle.
///
/// - `links`: La, L1, L2, L3, Lb, Lc; frames of any kind but for L1, L2. The result's joints are in the order a, 1, 2, 3, b, c.
/// - At most 8 solutions; `signs`: two bits for qa and qb (bit 0 and bit 1 where each is block 1; else the number of the root), bit 2 elbow.
/// - Axis c parallel to the three: qc free; one of its angles that leave the elbow within reach is given, if there is any. Elbow folded onto the shoulder: q1 free.
/// - qb double and the elbow out of reach: `near`, since rounding has decided about qc.
#[inline(always)]
pub fn three_parallel(links: &[Frame; 6]) -> Branches<6, 8> {
    let [la, l1, l2, l3, lb, lc] = links;
    let mut found = Branches::new();
    let lengths = extent(la) + extent(l1) + extent(l2) + extent(l3) + extent(lb) + extent(lc);
    let noise = ROUNDING * lengths;
    let (side1, side2) = (l1[1][1], l2[1][1]);
    let (normal, h) = (side1 * side2, l1[2][3] + side1 * l2[2][3]);
    // Third row of M L3 and of La⁻¹: the plane's normal, and its offset.
    let k = [normal * l3[2][0], normal * l3[2][1], normal * l3[2][2]];
    let k4 = normal * l3[2][3] + h;
    let (n, n4) = (column(la, 2), -dot(column(la, 2), column(la, 3)));
    let ic = inverse(lc);
    // n Rz(-qa) v = c (n1 v1 + n2 v2) + s (n1 v2 - n2 v1) + n3 v3, and k Rz(qb) v.
    let back = |v: Vector| [dot_constant([n[0], n[1], 0.0], v), dot_constant([-n[1], n[0], 0.0], v)];
    let forth = |v: Vector| [-k[0] * v[0] - k[1] * v[1], k[0] * v[1] - k[1] * v[0]];
    let (za, oa) = (column(&ic, 2), column(&ic, 3));
    let (zb, ob) = (column(lb, 2), column(lb, 3));
    // The third component has no unit; times a length of the arm it compares with the offset.
    let unit = extent(l1) + extent(l2);
    let unit = if unit > 0.0 { unit } else { 1.0 };
    let scaled = |[x, y]: [Real; 2]| [unit * x, unit * y];
    let m1 = [scaled(back(za)), back(oa)];
    let m2 = [scaled(forth(zb)), forth(ob)];
    let d = [unit * plus_product(k[2] * zb[2], -n[2], za[2]), plus_product(k[2] * ob[2] + k4 - n4, -n[2], oa[2])];
    // Of F = L3 Jb Lb, seen from behind: the first row, and the displacement.
    let (row, place) = ([l3[0][0], l3[0][1], l3[0][2]], rotate_back(l3, column(l3, 3)));
    let behind = rotate_back(lb, column(lb, 3));
    // G = Lc Ja La, and how long the normal is across axis c. Solutions come by their first angles, so that it serves two.
    let (mut known, mut g, mut sine) = ([Real::NAN; 2], IDENTITY, 0.0);
    let pairs = two_circles(m1, m2, d, [unit, lengths]);
    for solution in pairs.pairs.iter().take(pairs.count) {
        let (mut qa, mut qb) = (solution.a, solution.b);
        // The normal across axis c, from both sides; the angle that was found last is mended by the other side.
        if pairs.a_last {
            let from_b = constant_seen_behind(qb, lb, k);
            let [c, s] = mended(n, [qa[0], -qa[1]], &ic, length(from_b[0], from_b[1]));
            qa = [c, -s];
        }
        if qa != known {
            known = qa;
            g = constant_then(&after_turn(lc, qa), la);
            sine = length(g[0][2], g[1][2]);
        }
        if !pairs.a_last {
            qb = mended(k, qb, lb, sine);
        }
        let from_b = constant_seen_behind(qb, lb, k);
        let qc = turn_of_lengths(([g[0][2], g[1][2]], sine), ([from_b[0], from_b[1]], length(from_b[0], from_b[1])), ROUNDING);
        // M = (F Jc G)⁻¹. Of M what is across its axes: the displacement, and the first column.
        let (row, place) = (constant_seen_behind(qb, lb, row), constant_seen_behind(qb, lb, place));
        let base = [place[0] + behind[0], place[1] + behind[1], place[2] + behind[2]];
        let (gx, gy, gt) = (column(&g, 0), column(&g, 1), column(&g, 3));
        let bracket = |[c, s]: [Real; 2]| {
            let (row, [x, y, z]) = (turn_vector(c, -s, row), turn_vector(c, -s, base));
            let t = [x + gt[0], y + gt[1], z + gt[2]];
            ([-dot(gx, t), -dot(gy, t)], [dot(gx, row), dot(gy, row)])
        };
        let (a1, a2) = (l1[0][3], l2[0][3]);
        // Where two solutions for qb meet, axes c and of the three are parallel up to rounding, which then decides about qc.
        let open = qc.free || solution.double && qc.miss > 0.0;
        let qc = if open { Turn { value: within_reach(&|qc| bracket(qc).0, a1.abs(), a2.abs()), ..qc } } else { qc };
        let (place, turned) = bracket(qc.value);
        let (s1, s2) = (if a1 < 0.0 { -1.0 } else { 1.0 }, if a2 < 0.0 { -1.0 } else { 1.0 });
        let error = if sine < 0.125 { solution.error + error_beside_parallel(sine, qc.miss) } else { solution.error };
        let arm = two_links(a1.abs(), a2.abs(), place, noise, error * lengths);
        found.missed(arm.miss);
        found.near |= solution.double && arm.count == 0;
        let free = [solution.a_free, arm.shoulder_free, arm.elbow_free, false, solution.b_free, qc.free];
        let free = free.iter().rev().fold(0, |bits, free| bits << 1 | u32::from(*free));
        for (i, (shoulder, elbow)) in arm.shoulder.iter().zip(&arm.elbow).enumerate().take(arm.count) {
            // A negative length is a positive one turned by pi; the second link is seen through Rx(0 or pi).
            let q1 = [s1 * shoulder[0], s1 * shoulder[1]];
            let q2 = [s1 * s2 * elbow[0], s1 * s2 * side1 * elbow[1]];
            // What is left of M's turn.
            let [x, y, _] = turn_vector(q1[0], -q1[1], [turned[0], turned[1], 0.0]);
            let [x, y, _] = turn_vector(q2[0], -q2[1], [x, side1 * y, 0.0]);
            found.add(Branch {
                joints: [qa, q1, q2, [x, side2 * y], qb, qc.value],
                signs: solution.signs | (i as u16) << 2,
                double: solution.double || arm.double,
                error,
                free,
            });
        }
    }
    found.missed(pairs.miss);
    found.near |= pairs.near;
    found
}
