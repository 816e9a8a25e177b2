// Block 7: six revolute joints, three neighbours of which have parallel axes.

/// What `two_circles` finds.
struct TwoCircles {
    a: [Real; 2],
    b: [Real; 2],
    signs: u16,
    double: bool,
    a_free: bool,
    b_free: bool,
    /// qa comes from the last equation, else qb.
    a_last: bool,
    /// How far rounding may have moved the two angles together, rad.
    error: Real,
}

/// The solutions of the pair of equations m1 (ca, sa)' + m2 (cb, sb)' = d on two circles. Returns by how much the last way without one
/// missed, and whether rounding decides that there is none.
///
/// m2 singular: the combination of the equations that is free of b is block 1 in a, the other then block 1 in b; or the other way round.
/// Else the point of one circle is affine in that of the other, and on its circle: block R with D = 2.
fn two_circles(
    m1: [[Real; 2]; 2],
    m2: [[Real; 2]; 2],
    d: [Real; 2],
    noise: Real,
    mut found: impl FnMut(TwoCircles),
) -> (Real, bool) {
    let determinant = |m: [[Real; 2]; 2]| m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let size = |m: [[Real; 2]; 2]| m[0][0] * m[0][0] + m[0][1] * m[0][1] + m[1][0] * m[1][0] + m[1][1] * m[1][1];
    let (d1, d2) = (determinant(m1), determinant(m2));
    if d2.abs() <= ROUNDING * size(m2) {
        return (one_circle_first(m1, m2, d, noise, found), false);
    }
    if d1.abs() <= ROUNDING * size(m1) {
        let exchanged = |s: TwoCircles| found(TwoCircles { a: s.b, b: s.a, a_free: s.b_free, b_free: s.a_free, a_last: true, ..s });
        return (one_circle_first(m2, m1, d, noise, exchanged), false);
    }
    // The matrix that is farther from singular is inverted.
    let swapped = d2.abs() * size(m1) > d1.abs() * size(m2);
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
        found(TwoCircles { a, b, signs: i as u16, double: root.double, a_free: false, b_free: false, a_last: swapped, error });
    }
    if roots.free {
        found(TwoCircles { a: [1.0, 0.0], b: [1.0, 0.0], signs: 0, double: false, a_free: true, b_free: true, a_last: false, error: 0.0 });
    }
    (0.0, roots.near && roots.count == 0)
}

/// The same where m2 is singular.
fn one_circle_first(
    m1: [[Real; 2]; 2],
    m2: [[Real; 2]; 2],
    d: [Real; 2],
    noise: Real,
    mut found: impl FnMut(TwoCircles),
) -> Real {
    // The range of m2 is its larger column; across it the equations are free of b.
    let (n0, n1) = (length(m2[0][0], m2[1][0]), length(m2[0][1], m2[1][1]));
    let range = if n0 >= n1 { [m2[0][0] / n0, m2[1][0] / n0] } else { [m2[0][1] / n1, m2[1][1] / n1] };
    let range = if n0 + n1 > 0.0 { range } else { [1.0, 0.0] };
    let [x, y] = range;
    let along = |m: [[Real; 2]; 2]| [x * m[0][0] + y * m[1][0], x * m[0][1] + y * m[1][1]];
    let across = |m: [[Real; 2]; 2]| [x * m[1][0] - y * m[0][0], x * m[1][1] - y * m[0][1]];
    let [ac, as_] = across(m1);
    let first = line_and_circle(ac, as_, x * d[1] - y * d[0], noise, 0.0);
    let mut miss = first.miss;
    for (i, a) in points(&first) {
        let ([p, q], [bc, bs]) = (along(m1), along(m2));
        let second = line_and_circle(bc, bs, x * d[0] + y * d[1] - (p * a[0] + q * a[1]), noise, first.error * length(p, q));
        miss = if second.count == 0 { second.miss } else { miss };
        for (j, b) in points(&second) {
            found(TwoCircles {
                a,
                b,
                signs: i | j << 1,
                double: first.double || second.double,
                a_free: first.free,
                b_free: second.free,
                a_last: false,
                error: first.error + second.error,
            });
        }
    }
    miss
}

/// The row v Rz(q) F without its third component, for an angle q that this component has given; and q, mended where the component is nearly 1.
///
/// There it is a cosine, which leaves u/sine of q. The rest of the row is the sine itself, and `wanted` says how long it is:
/// d|rest|/dq = -(third/|rest|) d third/dq gives a step of Newton's.
#[inline]
fn seen_beside(v: Vector, q: [Real; 2], f: &Frame, wanted: Real) -> ([Real; 2], [Real; 2]) {
    let seen = |q: [Real; 2]| {
        let turned = turn_vector(q[0], -q[1], v);
        (turned, [dot(turned, column(f, 0)), dot(turned, column(f, 1))])
    };
    let (turned, rest) = seen(q);
    if !(wanted < 0.125) {
        return (rest, q);
    }
    // d(v Rz(q))/dq = (v2, -v1, 0) for the turned v.
    let (third, slope) = (dot(turned, column(f, 2)), turned[1] * f[0][2] - turned[0] * f[1][2]);
    let sine = length(rest[0], rest[1]);
    let step = (sine - wanted) * sine / (third * slope);
    // A larger one is no error of rounding.
    if !(step.abs() < 0.125 * sine) {
        return (rest, q);
    }
    let (c, s) = small_turn(step);
    let q = [c * q[0] - s * q[1], c * q[1] + s * q[0]];
    (seen(q).1, q)
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
pub fn three_parallel(links: &[Frame; 6]) -> Branches<6, 8> {
    let [la, l1, l2, l3, lb, lc] = links;
    let mut found = Branches::new();
    let lengths = links.iter().fold(0.0, |sum, f| sum + extent(f));
    let noise = ROUNDING * lengths;
    let (side1, side2) = (l1[1][1], l2[1][1]);
    let (normal, h) = (side1 * side2, l1[2][3] + side1 * l2[2][3]);
    // Third row of M L3 and of La⁻¹: the plane's normal, and its offset.
    let k = [normal * l3[2][0], normal * l3[2][1], normal * l3[2][2]];
    let k4 = normal * l3[2][3] + h;
    let (n, n4) = {
        let ia = inverse(la);
        ([ia[2][0], ia[2][1], ia[2][2]], ia[2][3])
    };
    let ic = inverse(lc);
    // n Rz(-qa) v = c (n1 v1 + n2 v2) + s (n1 v2 - n2 v1) + n3 v3, and k Rz(qb) v.
    let back = |v: Vector| [n[0] * v[0] + n[1] * v[1], n[0] * v[1] - n[1] * v[0]];
    let forth = |v: Vector| [-k[0] * v[0] - k[1] * v[1], k[0] * v[1] - k[1] * v[0]];
    let (za, oa) = (column(&ic, 2), column(&ic, 3));
    let (zb, ob) = (column(lb, 2), column(lb, 3));
    // The third component has no unit; times the arm's length it compares with the offset.
    let scaled = |[x, y]: [Real; 2]| [lengths * x, lengths * y];
    let m1 = [scaled(back(za)), back(oa)];
    let m2 = [scaled(forth(zb)), forth(ob)];
    let d = [lengths * (k[2] * zb[2] - n[2] * za[2]), k[2] * ob[2] + k4 - n[2] * oa[2] - n4];
    let (miss, near) = two_circles(m1, m2, d, noise, |solution| {
        let (qa, qb) = (solution.a, solution.b);
        // The normal across axis c, from both sides; the angle that was found last is mended by the other side.
        let across = |v: [Real; 2]| length(v[0], v[1]);
        let (mut from_a, mut back_a) = seen_beside(n, [qa[0], -qa[1]], &ic, 1.0);
        let (from_b, qb) = seen_beside(k, qb, lb, if solution.a_last { 1.0 } else { across(from_a) });
        if solution.a_last {
            (from_a, back_a) = seen_beside(n, back_a, &ic, across(from_b));
        }
        let qa = [back_a[0], -back_a[1]];
        let qc = turn(from_a, from_b, ROUNDING);
        // M = (L3 Jb Lb Jc Lc Ja La)⁻¹
        let (first, last) = (compose(l3, &joint_then(false, qb, lb)), compose(lc, &joint_then(false, qa, la)));
        // Of M what is across its axes: the displacement, and the first column.
        let base = rotate_back(&first, column(&first, 3));
        let bracket = |qc: [Real; 2]| {
            let g = joint_then(false, qc, &last);
            let t = [base[0] + g[0][3], base[1] + g[1][3], base[2] + g[2][3]];
            ([-dot(column(&g, 0), t), -dot(column(&g, 1), t)], rotate_back(&g, [first[0][0], first[0][1], first[0][2]]))
        };
        let (a1, a2) = (l1[0][3], l2[0][3]);
        // Where two solutions for qb meet, axes c and of the three are parallel up to rounding, which then decides about qc.
        let open = qc.free || solution.double && qc.miss > 0.0;
        let qc = if open { Turn { value: within_reach(&|qc| bracket(qc).0, a1.abs(), a2.abs()), ..qc } } else { qc };
        let (place, turned) = bracket(qc.value);
        let (s1, s2) = (if a1 < 0.0 { -1.0 } else { 1.0 }, if a2 < 0.0 { -1.0 } else { 1.0 });
        let arm = two_links(a1.abs(), a2.abs(), place, noise, solution.error * lengths);
        found.missed(arm.miss);
        found.near |= solution.double && arm.count == 0;
        for (i, (shoulder, elbow)) in arm.shoulder.iter().zip(&arm.elbow).enumerate().take(arm.count) {
            // A negative length is a positive one turned by pi; the second link is seen through Rx(0 or pi).
            let q1 = [s1 * shoulder[0], s1 * shoulder[1]];
            let q2 = [s1 * s2 * elbow[0], s1 * s2 * side1 * elbow[1]];
            // What is left of M's turn.
            let [x, y, _] = turn_vector(q1[0], -q1[1], turned);
            let [x, y, _] = turn_vector(q2[0], -q2[1], [x, side1 * y, 0.0]);
            let free = [solution.a_free, arm.shoulder_free, arm.elbow_free, false, solution.b_free, qc.free];
            found.add(Branch {
                joints: [qa, q1, q2, [x, side2 * y], qb, qc.value],
                signs: solution.signs | (i as u16) << 2,
                double: solution.double || arm.double,
                error: solution.error,
                free: free.iter().rev().fold(0, |bits, free| bits << 1 | u32::from(*free)),
            });
        }
    });
    found.missed(miss);
    found.near |= near;
    found
}
