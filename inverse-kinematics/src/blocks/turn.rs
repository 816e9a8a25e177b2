// Block 2: the turn that takes one vector of the plane to another.

/// The turn that [`turn`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// Its cosine and sine.
    pub value: [Real; 2],
    /// Both vectors vanish: every turn does; (1, 0) is given.
    pub free: bool,
    /// The difference of the lengths where it is more than `noise`, else 0.
    pub miss: Real,
}

/// Block 2, turn about z: Rz(q) x = y in the plane.
///
/// c = x·y/(|x| |y|), s = (x × y)_z/(|x| |y|) (Paden 1986, subproblem 1).
///
/// - `noise`: how far rounding may have moved x and y, >= 0.
/// - |x|, |y| <= noise: `free`. Lengths that differ by more than noise: `miss`, and the turn that takes the directions to each other.
#[inline]
pub fn turn(x: [Real; 2], y: [Real; 2], noise: Real) -> Turn {
    turn_of_lengths((x, length(x[0], x[1])), (y, length(y[0], y[1])), noise)
}

/// [`turn`] of vectors whose lengths are known.
#[inline]
pub fn turn_of_lengths((x, m): ([Real; 2], Real), (y, n): ([Real; 2], Real), noise: Real) -> Turn {
    let difference = (m - n).abs();
    let miss = if difference <= noise { 0.0 } else { difference };
    if m > noise && n > noise {
        let over = 1.0 / (m * n);
        let value = [(x[0] * y[0] + x[1] * y[1]) * over, (x[0] * y[1] - x[1] * y[0]) * over];
        Turn { value, free: false, miss }
    } else {
        Turn { value: [1.0, 0.0], free: miss == 0.0, miss }
    }
}
