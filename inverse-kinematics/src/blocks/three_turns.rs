// Block 5: a rotation as three turns about given axes.

/// The turns that [`three_turns`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreeTurns {
    /// How many of `turns` count: 0, 1 or 2.
    pub count: usize,
    /// (cos, sin) of t1, t2, t3; first the one with sin t2 >= 0.
    pub turns: [[[Real; 2]; 3]; 2],
    /// The two solutions meet as far as rounding lets one tell, with t1 and t3 determined; one is given.
    pub double: bool,
    /// Axes 1 and 3 are parallel: only t1 + t3 or t1 - t3 is determined; t1 = 0 is given, or where they are so by doubt alone what t1 comes to.
    pub free: bool,
    /// The defect in the cosine between axes 1 and 3 where there is none, else 0.
    pub miss: Real,
}

/// Block 5, three turns: R = Rz(t1) Rx(alpha) Rz(t2) Rx(beta) Rz(t3); sin alpha and sin beta are not 0.
///
/// R33 = cos alpha cos beta - sin alpha sin beta cos t2 is the cosine between axes 1 and 3. With D1 = cos(alpha - beta) - R33 and
/// D2 = R33 - cos(alpha + beta), (sin alpha sin beta sin t2)² = D1 D2. Where R33 is near such a cosine the difference is
/// (h² - sin²)/(sum of the cosines) with h = hypot(R13, R23) the sine between the axes, not a difference of cosines: otherwise half the
/// digits of t2 are gone near the pose at which both axes are parallel.
/// t1 then takes the third column of Rx(alpha) Rz(t2) Rx(beta) to that of R, and t3 is what is left of R, so that R is met even
/// where t1 and t3 are badly determined.
///
/// - `r`: its rotation is R. `alpha`, `beta`: (cos, sin). `noise`: how far rounding may have moved R's entries. `doubt`: how far they may be
///   off besides, by errors of angles that they were computed from; what misses by no more is met at the end of the range, and axes that
///   are parallel to no more are `free`, with t1 and t3 as they come out.
/// - h <= noise with axes that can be parallel: `free`. D1 or D2 within its noise of 0: `double`. Negative: none, `miss` = -D.
#[inline]
pub fn three_turns(r: &Frame, alpha: [Real; 2], beta: [Real; 2], noise: Real, doubt: Real) -> ThreeTurns {
    let mut found = ThreeTurns { count: 0, turns: [[[1.0, 0.0]; 3]; 2], double: false, free: false, miss: 0.0 };
    let ([ca, sa], [cb, sb]) = (alpha, beta);
    let (z, h) = (r[2][2], length(r[0][2], r[1][2]));
    // The cosine `c` with the sine `s` less that of z with the sine h, and whether it is 0 to rounding.
    let difference = |c: Real, s: Real| {
        let (sum, d, e) = (c + z, h - s.abs(), h + s.abs());
        // The cosine loses digits where both sines are small, the sines where both are near 1.
        let by_sines = sum.abs() > 1.0;
        let (above, below) = if by_sines { (d * e, sum) } else { (c - z, 1.0) };
        let off = if by_sines { d } else { c - z };
        (above / below, off.abs() <= noise)
    };
    let (d1, zero1) = difference(ca * cb + sa * sb, sa * cb - ca * sb);
    let (d2, zero2) = difference(ca * cb - sa * sb, sa * cb + ca * sb);
    let (d1, d2) = if sa * sb > 0.0 { (d1, -d2) } else { (-d1, d2) };
    let (zero1, zero2) = (zero1 || (d1 < 0.0 && d1 >= -doubt), zero2 || (d2 < 0.0 && d2 >= -doubt));
    let double = zero1 || zero2;
    if !(double || (d1 > 0.0 && d2 > 0.0)) {
        found.miss = if d1 < d2 { -d1 } else { -d2 };
        return found;
    }
    let over = 1.0 / (sa * sb);
    let (c2, s2) = if double {
        (if zero1 { -1.0 } else { 1.0 }, 0.0)
    } else {
        ((ca * cb - z) * over, sqrt(d1 * d2) * over.abs())
    };
    // At the end of the range with axes 1 and 3 parallel.
    let parallel = double && h <= noise;
    // So nearly that errors of other angles decide: t1 and t3 are given as they come out, so that R is met.
    let can_be = |c: Real, s: Real| s.abs() <= noise && c * z > 0.0;
    let nearly = h <= noise + doubt && (can_be(ca * cb + sa * sb, sa * cb - ca * sb) || can_be(ca * cb - sa * sb, sa * cb + ca * sb));
    found.free = parallel || nearly;
    found.double = double && !found.free;
    found.count = if double { 1 } else { 2 };
    let (side, along) = (plus_product(sa * cb, ca * sb, c2), s2 * sb);
    // Block 2 of the third columns, of the same lengths for both signs of s2.
    let lengths = length(along, side) * h;
    let over = if lengths > 0.0 { 1.0 / lengths } else { 0.0 };
    let mut sign = 1.0;
    for turns in &mut found.turns {
        let (s2, along) = (sign * s2, sign * along);
        sign = -sign;
        let t1 = if parallel || over == 0.0 {
            [1.0, 0.0]
        } else {
            [plus_product(along * r[0][2], -side, r[1][2]) * over, plus_product(along * r[1][2], side, r[0][2]) * over]
        };
        // R's first column, seen from before Rx(beta) Rz(t3).
        let x = turn_vector(t1[0], -t1[1], column(r, 0));
        let (y, z) = (plus_product(plus_product(-0.0, ca, x[1]), sa, x[2]), plus_product(plus_product(-0.0, ca, x[2]), -sa, x[1]));
        let (x, y) = (c2 * x[0] + s2 * y, c2 * y - s2 * x[0]);
        *turns = [t1, [c2, s2], back_on_circle([x, plus_product(plus_product(-0.0, cb, y), sb, z)])];
    }
    found
}
