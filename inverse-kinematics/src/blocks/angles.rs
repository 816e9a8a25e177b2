// Angles of points of the circle.

/// pi.
pub const HALF_TURN: Real = 3.141592653589793238462643383279502884;

/// The angle of (c, s) in (-pi, pi], rad, given that of a point `known`: the same, opposite and mirrored points, of which solutions of one arm
/// have many (the two postures of a wrist), cost no arctangent. Right to 2 u beside the rounding of (c, s).
#[inline]
pub fn angle_beside(known: [Real; 2], angle: Real, [c, s]: [Real; 2]) -> Real {
    let [x, y] = known;
    let found = if c == x && s == y {
        angle
    } else if c == x && s == -y {
        -angle
    } else if c == -x && s == -y {
        angle + if angle > 0.0 { -HALF_TURN } else { HALF_TURN }
    } else {
        atan2(s, c)
    };
    // -pi is pi.
    if found > -HALF_TURN {
        found
    } else {
        HALF_TURN
    }
}
