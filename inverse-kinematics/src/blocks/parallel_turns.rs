// Four joints whose revolute axes are all parallel.

/// All revolute axes parallel (SCARA and planar arms): J1 L1 J2 L2 J3 L3 J4 L4 = 1, joint 4 revolute, the axes of all revolute joints of 1 to
/// 3 parallel to that of joint 4, at most 2 of them.
///
/// The origin of joint 4 does not feel it: block 6, as `regional`, brings L3 0 to what L4⁻¹ makes of the origin; then q4 is what is left of
/// the turn.
///
/// - `links`: L1 to L4. `prismatic`: the kinds of joints 1 to 3. `regional(L1, L2, w, p)`: the case of block 6 that holds for L1 and L2.
/// - At most 4 solutions; `signs` of block 6. A rotation that a turn about axis 4 cannot complete: none, `miss` is the defect of the tilted
///   entries (no unit), more than [`ROUNDING`].
#[inline]
pub fn parallel_turns(
    links: &[Frame; 4],
    prismatic: [bool; 3],
    regional: impl Fn(&Frame, &Frame, Vector, Vector) -> Branches<3, 4>,
) -> Branches<4, 4> {
    let [l1, l2, l3, l4] = links;
    let mut found = Branches::new();
    let back = inverse(l4);
    let arm = regional(l1, l2, column(l3, 3), column(&back, 3));
    (found.miss, found.near) = (arm.miss, arm.near);
    // What a turn about these axes does not change is judged once: where the loop without its turns takes the directions of the last link.
    let behind_2 = compose(l2, l3);
    let behind = [compose(l1, &behind_2), behind_2, *l3];
    let seen = |v: Vector| rotate_back_constant(&behind[0], v);
    let (x, y, z) = (seen(column(&back, 0)), seen(column(&back, 1)), seen(column(&back, 2)));
    let tilt = x[2] * x[2] + y[2] * y[2] + z[0] * z[0] + z[1] * z[1];
    let met = tilt <= ROUNDING * ROUNDING && z[2] > 0.0;
    for branch in arm.all.iter().take(arm.count) {
        if !met {
            found.missed(if z[2] > 0.0 { sqrt(tilt) } else { 1.0 - z[2] });
            continue;
        }
        let mut left = x;
        for ((value, prismatic), behind) in branch.joints.iter().zip(prismatic).zip(&behind) {
            if !prismatic {
                // Seen from joint 4, this axis points up or down.
                left = turn_vector(value[0], -value[1] * behind[2][2], left);
            }
        }
        let [q1, q2, q3] = branch.joints;
        found.add(Branch { joints: [q1, q2, q3, [left[0], left[1]]], signs: branch.signs, double: branch.double, error: branch.error, free: branch.free });
    }
    found
}
