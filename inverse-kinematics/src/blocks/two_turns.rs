// Block 3: two turns about axes through one point.

/// The pairs of turns that [`two_turns`] finds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoTurns {
    /// How many of `first` and `second` count: 0, 1 or 2.
    pub count: usize,
    /// (cos t1, sin t1).
    pub first: [[Real; 2]; 2],
    /// (cos t2, sin t2).
    pub second: [[Real; 2]; 2],
    /// The two pairs meet as far as rounding lets one tell; one is given.
    pub double: bool,
    /// t1 can be anything: p is on axis 1. (1, 0) is given.
    pub first_free: bool,
    /// t2 can be anything: p2 is on axis 2. (1, 0) is given.
    pub second_free: bool,
    /// How far p and p2 are from being taken to each other: the difference of their lengths, or the miss of block 1; else 0.
    pub miss: Real,
}

/// Block 3, two turns: R(k1, t1) p = R(k2, t2) p2 for unit vectors k1, k2 that are not parallel (Paden 1986, subproblem 2).
///
/// R(k, t) v = k (k·v) + c (v - k (k·v)) + s k × v. Multiplied by k1 from the left, t1 vanishes: k1·p = k1·R(k2, t2) p2 is block 1 in t2;
/// block 2 in the plane normal to k1 gives t1.
/// p on k1: `first_free`; p2 on k2: `second_free`. `noise` as in blocks 1 and 2.
pub fn two_turns(k1: Vector, p: Vector, k2: Vector, p2: Vector, noise: Real) -> TwoTurns {
    let mut found = TwoTurns {
        count: 0,
        first: [[1.0, 0.0]; 2],
        second: [[1.0, 0.0]; 2],
        double: false,
        first_free: false,
        second_free: false,
        miss: 0.0,
    };
    let difference = (sqrt(dot(p, p)) - sqrt(dot(p2, p2))).abs();
    if !(difference <= noise) {
        found.miss = difference;
        return found;
    }
    let across = |k: Vector, v: Vector| {
        let along = dot(k, v);
        [v[0] - along * k[0], v[1] - along * k[1], v[2] - along * k[2]]
    };
    let (x2, y2) = (across(k2, p2), cross(k2, p2));
    let line = line_and_circle(dot(k1, x2), dot(k1, y2), dot(k1, p) - dot(k1, k2) * dot(k2, p2), noise, 0.0);
    (found.double, found.second_free, found.miss) = (line.double, line.free, line.miss);
    let (x1, y1) = (across(k1, p), cross(k1, p));
    for (i, point) in line.points.iter().enumerate().take(line.count) {
        let [c, s] = *point;
        let moved = [
            p2[0] + (c - 1.0) * x2[0] + s * y2[0],
            p2[1] + (c - 1.0) * x2[1] + s * y2[1],
            p2[2] + (c - 1.0) * x2[2] + s * y2[2],
        ];
        let n = sqrt(dot(x1, x1));
        let first = turn([n, 0.0], if n > noise { [dot(x1, moved) / n, dot(y1, moved) / n] } else { [0.0, 0.0] }, noise);
        found.first_free |= first.free;
        if let (Some(t1), Some(t2)) = (found.first.get_mut(i), found.second.get_mut(i)) {
            (*t1, *t2) = (first.value, *point);
        }
        found.count = i + 1;
    }
    found
}
