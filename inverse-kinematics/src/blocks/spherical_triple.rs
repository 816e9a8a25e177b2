// Six joints, three neighbours of which turn about axes through one point.

/// Spherical triple: J1 L1 J2 L2 J3 L3 J4 L4 J5 L5 J6 L6 = 1 with L4 = Tz(d) Rx(alpha), L5 = Rx(beta); sin alpha and sin beta are not 0.
///
/// The point in which axes 4, 5 and 6 meet does not feel them: block 6, as `regional`, brings L3 (0, 0, d) to what L6⁻¹ makes of the origin.
/// The rotation that is left is block 5 (Pieper 1968).
///
/// - `links`: L1 to L6. `prismatic`: the kinds of joints 1 to 3. `regional(L1, L2, w, p)`: the case of block 6 that holds for L1 and L2.
/// - At most 8 solutions; `signs`: two bits of block 6, then bit 2 wrist (the sign of sin q5).
/// - Axes 4 and 6 parallel: q4 and q6 free together, q4 = 0.
#[inline]
pub fn spherical_triple(
    links: &[Frame; 6],
    prismatic: [bool; 3],
    regional: impl Fn(&Frame, &Frame, Vector, Vector) -> Branches<3, 4>,
) -> Branches<6, 8> {
    let [l1, l2, l3, l4, l5, l6] = links;
    let mut found = Branches::new();
    let back = inverse(l6);
    let arm = regional(l1, l2, transform(l3, [0.0, 0.0, l4[2][3]]), column(&back, 3));
    (found.miss, found.near) = (arm.miss, arm.near);
    let [p1, p2, p3] = prismatic;
    let whole = [column(&back, 0), column(&back, 1), column(&back, 2)];
    // Branches come by their first joints: what is left behind joint 1 serves two.
    let (mut first, mut behind) = ([Real::NAN; 2], whole);
    for branch in arm.found() {
        let [q1, q2, q3] = branch.joints;
        // The elbow's, from a division by its lengths, may be off by more than a few units.
        let q3 = if p3 { q3 } else { back_on_circle(q3) };
        if q1 != first {
            (first, behind) = (q1, seen_behind(p1, q1, l1, whole));
        }
        let [x, y, z] = seen_behind(p3, q3, l3, seen_behind(p2, q2, l2, behind));
        let rest = [[x[0], y[0], z[0], 0.0], [x[1], y[1], z[1], 0.0], [x[2], y[2], z[2], 0.0]];
        let wrist = three_turns(&rest, [l4[2][2], l4[2][1]], [l5[2][2], l5[2][1]], ROUNDING, branch.error);
        found.missed(wrist.miss);
        for (i, [q4, q5, q6]) in wrist.turns.iter().enumerate().take(wrist.count) {
            found.add(Branch {
                joints: [q1, q2, q3, *q4, *q5, *q6],
                signs: branch.signs | (i as u16) << 2,
                double: branch.double || wrist.double,
                error: branch.error,
                free: branch.free | if wrist.free { 0b101000 } else { 0 },
            });
        }
    }
    found
}
