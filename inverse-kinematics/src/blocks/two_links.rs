// Block 4: two links in a plane.

/// The postures that [`two_links`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLinks {
    /// How many of `shoulder` and `elbow` count: 0, 1 or 2.
    pub count: usize,
    /// (cos q1, sin q1) of the first joint.
    pub shoulder: [[Real; 2]; 2],
    /// (cos q2, sin q2) of the second joint; first the one with sin q2 >= 0.
    pub elbow: [[Real; 2]; 2],
    /// Stretched or folded as far as rounding and doubt let one tell. By rounding alone the two postures are given as one.
    pub double: bool,
    /// The first joint can take any angle: p = 0 and both links are equally long. (1, 0) is given.
    pub shoulder_free: bool,
    /// The second joint can take any angle: the second link has no length. (1, 0) is given.
    pub elbow_free: bool,
    /// The distance of |p| from [|l1 - l2|, l1 + l2], 0 where there is a posture.
    pub miss: Real,
    /// How far rounding and doubt may have moved q2, rad.
    pub error: Real,
}

/// Block 4, two links in a plane: p = Rz(q1) (l1 + l2 cos q2, l2 sin q2) for lengths l1, l2 >= 0.
///
/// cos q2 = (|p|² - l1² - l2²)/(2 l1 l2); (2 l1 l2 sin q2)² = (l1 + l2 - |p|)(l1 + l2 + |p|)(|p| - |l1 - l2|)(|p| + |l1 - l2|), a product,
/// so that the sine keeps its digits near the stretched and the folded arm. q1 by block 2.
///
/// - `noise`: how far rounding may have moved |p|, l1 and l2, >= 0. `doubt`: how far p may be off besides, by errors of the angles that it was
///   computed from.
/// - |p| within noise + doubt of l1 + l2 or of |l1 - l2|: `double`. Two postures where |p| is within the bounds by more than noise: they reach p.
/// - p = 0 and l1 = l2: `shoulder_free`. l1 or l2 within noise of 0 and |p| right: `elbow_free`.
#[inline]
pub fn two_links(l1: Real, l2: Real, p: [Real; 2], noise: Real, doubt: Real) -> TwoLinks {
    let mut found = TwoLinks {
        count: 0,
        shoulder: [[1.0, 0.0]; 2],
        elbow: [[1.0, 0.0]; 2],
        double: false,
        shoulder_free: false,
        elbow_free: false,
        miss: 0.0,
        error: 0.0,
    };
    let square = p[0] * p[0] + p[1] * p[1];
    let distance = sqrt(square);
    let (outer, inner) = (l1 + l2 - distance, distance - (l1 - l2).abs());
    let slack = noise + doubt;
    if !(outer >= -slack && inner >= -slack) {
        found.miss = if outer < inner { -outer } else { -inner };
        return found;
    }
    if !(l1 > noise && l2 > noise) {
        found.count = 1;
        found.elbow_free = true;
    } else {
        let over = 0.5 / (l1 * l2);
        found.double = outer <= slack || inner <= slack;
        found.count = 1;
        let mut s = 0.0;
        if outer > noise && inner > noise {
            found.count = 2;
            let c = (square - l1 * l1 - l2 * l2) * over;
            s = sqrt((outer * (l1 + l2 + distance)) * (inner * (distance + (l1 - l2).abs()))) * over;
            found.elbow = [[c, s], [c, -s]];
        } else if outer > noise {
            found.elbow = [[-1.0, 0.0]; 2];
        }
        // cos q2 moves by |p|/(l1 l2) times what |p| does.
        let moved = 2.0 * over * slack;
        found.error = if found.double { sqrt(2.0 * moved * (l1 + l2)) } else { moved * distance / s };
    }
    // Both postures lead to points (x, ±y): block 2 of the first, and of the other with the same lengths.
    let [first, _] = found.elbow;
    let (x, y) = (l1 + l2 * first[0], l2 * first[1]);
    let reached = x * x + y * y;
    if reached > noise * noise && distance > noise {
        let over = if found.count == 2 && FOLDED * distance > l1 + l2 {
            // Rounding alone tells |(x, y)| from |p|: a step of Newton's makes up for it without a root.
            let over = 1.0 / square;
            (1.5 - 0.5 * (reached * over)) * over
        } else {
            1.0 / (sqrt(reached) * distance)
        };
        let (x, y) = (x * over, y * over);
        let (xs, ys) = ([x * p[0], x * p[1]], [y * p[0], y * p[1]]);
        found.shoulder = [[xs[0] + ys[1], xs[1] - ys[0]], [xs[0] - ys[1], xs[1] + ys[0]]];
    } else {
        found.shoulder_free = (sqrt(reached) - distance).abs() <= noise;
    }
    found
}

/// From a distance of the sum of the lengths over this on, the lengths of the two vectors of [`two_links`] agree to 1e-13, or 6e-5 in single
/// precision, of which the square is nothing.
const FOLDED: Real = 1000.0;
