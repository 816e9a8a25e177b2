// Block 1: the points of the unit circle on a line.

/// The points that [`line_and_circle`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineAndCircle {
    /// How many of `points` count: 0, 1 or 2.
    pub count: usize,
    /// The points (c, s): first the one with the positive root, anticlockwise from (a, b) d/r.
    pub points: [[Real; 2]; 2],
    /// The line touches the circle as far as rounding and doubt let one tell. By rounding alone the two points are given as one.
    pub double: bool,
    /// The equation is empty: every point of the circle is on it; (1, 0) is given.
    pub free: bool,
    /// The length by which line and circle miss each other, in the unit of a, b, d; 0 where there is a point.
    pub miss: Real,
    /// How far rounding may have moved the points, rad.
    pub error: Real,
}

/// Block 1, line and circle: a c + b s = d with c² + s² = 1.
///
/// r = sqrt(a² + b²), D = (r - d)(r + d), w = sqrt(D): c = (a d ∓ b w)/r², s = (b d ± a w)/r²
/// (Paden 1986, subproblem 3; Elias, Wen 2025, subproblems 3 and 4).
/// D is the product, not r² - d², so that its relative error stays small down to where r - |d| is `noise`.
///
/// - `noise`: how far rounding may have moved d, a and b, >= 0, in the unit of d. `doubt`: how far d may be off besides, by errors of the angles
///   that it was computed from.
/// - r <= noise: with |d| <= noise every angle is a solution (`free`). With |d| <= noise + doubt the angle is unknown: (1, 0) is given, `double`, with an
///   error of pi. Else none, and the line misses by |d|.
/// - |r - |d|| <= noise + doubt: `double`. Two points where r - |d| is more than noise: they meet the equation, as the angles that d was
///   computed from stand, and what lies between them does not. Else the point of contact; the root w, which is below sqrt(2 noise/r), is dropped.
/// - r < |d|: none; `miss` is |d| - r. NaN in any argument: none.
#[inline]
pub fn line_and_circle(a: Real, b: Real, d: Real, noise: Real, doubt: Real) -> LineAndCircle {
    let mut found = LineAndCircle { count: 0, points: [[1.0, 0.0]; 2], double: false, free: false, miss: 0.0, error: 0.0 };
    let r = length(a, b);
    let gap = r - d.abs();
    let slack = noise + doubt;
    if gap > noise && r > noise && slack >= noise {
        let over = 1.0 / r;
        let (x, y) = (a * over, b * over);
        let along = d * over;
        let w = sqrt(gap * (r + d.abs()));
        found.double = gap <= slack;
        found.error = if found.double { sqrt(2.0 * slack * over) } else { slack / w };
        let w = w * over;
        found.count = 2;
        found.points = [[x * along - y * w, y * along + x * w], [x * along + y * w, y * along - x * w]];
    } else if r > noise && gap.abs() <= slack {
        found.count = 1;
        found.double = true;
        found.error = sqrt(2.0 * slack / r);
        let over = if d < 0.0 { -1.0 / r } else { 1.0 / r };
        found.points = [[a * over, b * over]; 2];
    } else if gap.abs() <= noise {
        found.count = 1;
        found.free = true;
    } else if r <= noise && gap.abs() <= slack {
        // What the other angles are off by decides about this one.
        found.count = 1;
        found.double = true;
        found.error = 3.141592653589793;
    } else {
        found.miss = -gap;
    }
    found
}
