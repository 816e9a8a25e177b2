// Frames: rigid displacements as three rows of four, the rotation beside the displacement.
// A revolute joint displaces by Rz(q), a prismatic one by Tz(q); a joint's value is (cos q, sin q), or (q, 0).

/// How far rounding may move a quantity that is put together from entries of a frame in a handful of operations, relative to the largest
/// of them: the entries themselves are right to 16 u (a pose computed from joint variables), and so are the constants of the arm.
pub const ROUNDING: Real = 64.0 * UNIT_ROUNDOFF;

/// A rigid displacement x -> R x + t: rows of (R | t).
pub type Frame = [[Real; 4]; 3];

/// A point or a direction.
pub type Vector = [Real; 3];

/// The displacement that moves nothing.
pub const IDENTITY: Frame = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

/// u · v.
#[inline]
pub fn dot(u: Vector, v: Vector) -> Real {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

/// sum + k x; the sum alone where k is 0. For a constant k of the arm: where it is known at compile time, products with 0 cost nothing, which the
/// rules of floats forbid a compiler to leave out. Sums begin with -0.0, to which anything can be added as it is. What takes constants
/// is always inlined: behind a call nothing is known of them.
#[inline(always)]
pub fn plus_product(sum: Real, k: Real, x: Real) -> Real {
    if k == 0.0 {
        sum
    } else {
        sum + k * x
    }
}

/// k · v for a constant k of the arm.
#[inline(always)]
pub fn dot_constant(k: Vector, v: Vector) -> Real {
    plus_product(plus_product(plus_product(-0.0, k[0], v[0]), k[1], v[1]), k[2], v[2])
}

/// u × v.
#[inline]
pub fn cross(u: Vector, v: Vector) -> Vector {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// u - v.
#[inline]
pub fn minus(u: Vector, v: Vector) -> Vector {
    [u[0] - v[0], u[1] - v[1], u[2] - v[2]]
}

/// The length of (x, y).
#[inline]
pub fn length(x: Real, y: Real) -> Real {
    sqrt(x * x + y * y)
}

/// The length of (x, y) where y is 0 for most arms, known at compile time: then no root is taken.
#[inline]
pub fn length_on_axis(x: Real, y: Real) -> Real {
    if y == 0.0 {
        x.abs()
    } else {
        length(x, y)
    }
}

/// The direction of a vector of the plane of this length; (1, 0) of none.
#[inline]
pub fn direction([x, y]: [Real; 2], length: Real) -> [Real; 2] {
    if length > 0.0 {
        let over = 1.0 / length;
        [x * over, y * over]
    } else {
        [1.0, 0.0]
    }
}

/// Column j of a frame: a direction for j < 3, the displacement for j = 3.
#[inline]
pub fn column(f: &Frame, j: usize) -> Vector {
    let j = if j < 4 { j } else { 3 };
    [f[0][j], f[1][j], f[2][j]]
}

/// R v, without the displacement.
#[inline]
pub fn rotate(f: &Frame, v: Vector) -> Vector {
    let row = |r: &[Real; 4]| r[0] * v[0] + r[1] * v[1] + r[2] * v[2];
    [row(&f[0]), row(&f[1]), row(&f[2])]
}

/// R' v, the transposed rotation.
#[inline]
pub fn rotate_back(f: &Frame, v: Vector) -> Vector {
    [dot(column(f, 0), v), dot(column(f, 1), v), dot(column(f, 2), v)]
}

/// R v + t.
#[inline]
pub fn transform(f: &Frame, v: Vector) -> Vector {
    let r = rotate(f, v);
    [r[0] + f[0][3], r[1] + f[1][3], r[2] + f[2][3]]
}

/// First `g`, then `f`.
#[inline]
pub fn compose(f: &Frame, g: &Frame) -> Frame {
    let row = |r: &[Real; 4]| {
        let entry = |j: usize| r[0] * g[0][j] + r[1] * g[1][j] + r[2] * g[2][j];
        [entry(0), entry(1), entry(2), entry(3) + r[3]]
    };
    [row(&f[0]), row(&f[1]), row(&f[2])]
}

/// First `g`, then a constant `f` of the arm.
#[inline(always)]
pub fn compose_constant(f: &Frame, g: &Frame) -> Frame {
    let row = |r: &[Real; 4]| {
        let entry = |j: usize| dot_constant([r[0], r[1], r[2]], column(g, j));
        [entry(0), entry(1), entry(2), entry(3) + r[3]]
    };
    [row(&f[0]), row(&f[1]), row(&f[2])]
}

/// First a constant `g` of the arm, then `f`.
#[inline(always)]
pub fn constant_then(f: &Frame, g: &Frame) -> Frame {
    let row = |r: &[Real; 4]| {
        let entry = |j: usize| dot_constant(column(g, j), [r[0], r[1], r[2]]);
        [entry(0), entry(1), entry(2), entry(3) + r[3]]
    };
    [row(&f[0]), row(&f[1]), row(&f[2])]
}

/// R' v for a constant frame of the arm.
#[inline(always)]
pub fn rotate_back_constant(f: &Frame, v: Vector) -> Vector {
    [dot_constant(column(f, 0), v), dot_constant(column(f, 1), v), dot_constant(column(f, 2), v)]
}

/// The displacement that undoes `f`, with the transposed rotation.
#[inline]
pub fn inverse(f: &Frame) -> Frame {
    let t = column(f, 3);
    let row = |j: usize| {
        let r = column(f, j);
        [r[0], r[1], r[2], -dot(r, t)]
    };
    [row(0), row(1), row(2)]
}

/// A point that only rounding has taken off the circle, back on it: Newton's step for the root of c² + s², which leaves the square of what it
/// was off.
#[inline]
pub fn back_on_circle([c, s]: [Real; 2]) -> [Real; 2] {
    let over = 1.5 - 0.5 * (c * c + s * s);
    [c * over, s * over]
}

/// First Rz of the angle of (c, s), then `f`.
#[inline]
pub fn after_turn(f: &Frame, [c, s]: [Real; 2]) -> Frame {
    let row = |r: &[Real; 4]| [c * r[0] + s * r[1], c * r[1] - s * r[0], r[2], r[3]];
    [row(&f[0]), row(&f[1]), row(&f[2])]
}

/// Rz(angle) v for the angle of (c, s).
#[inline]
pub fn turn_vector(c: Real, s: Real, v: Vector) -> Vector {
    [c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]]
}

/// First `f`, then a joint: Rz or Tz of its value (c, s) or (q, 0).
#[inline]
pub fn joint_then(prismatic: bool, value: [Real; 2], f: &Frame) -> Frame {
    if prismatic {
        let [x, y, mut z] = *f;
        z[3] += value[0];
        [x, y, z]
    } else {
        let [c, s] = value;
        let turned = |j: usize| (c * f[0][j] - s * f[1][j], s * f[0][j] + c * f[1][j]);
        let ((x0, y0), (x1, y1), (x2, y2), (x3, y3)) = (turned(0), turned(1), turned(2), turned(3));
        [[x0, x1, x2, x3], [y0, y1, y2, y3], f[2]]
    }
}

/// Rz(-angle) v for the angle of (c, s), or Tz(-q) v.
#[inline]
pub fn joint_back(prismatic: bool, value: [Real; 2], v: Vector) -> Vector {
    if prismatic {
        [v[0], v[1], v[2] - value[0]]
    } else {
        turn_vector(value[0], -value[1], v)
    }
}

/// Directions as seen from behind a joint and a constant link.
#[inline]
pub fn seen_behind(prismatic: bool, [c, s]: [Real; 2], link: &Frame, [x, y, z]: [Vector; 3]) -> [Vector; 3] {
    let seen = |v: Vector| rotate_back_constant(link, if prismatic { v } else { turn_vector(c, -s, v) });
    [seen(x), seen(y), seen(z)]
}

/// A constant direction of the arm as seen from behind a revolute joint and a constant link.
#[inline(always)]
pub fn constant_seen_behind([c, s]: [Real; 2], link: &Frame, v: Vector) -> Vector {
    let turned = |x: Real, y: Real| plus_product(plus_product(-0.0, x, c), y, s);
    rotate_back_constant(link, [turned(v[0], v[1]), turned(v[1], -v[0]), v[2]])
}

/// The sum of the absolute entries of the displacement.
#[inline]
pub fn extent(f: &Frame) -> Real {
    f[0][3].abs() + f[1][3].abs() + f[2][3].abs()
}

/// Cosine and sine of a small angle, |x| <= 1/2, by their series: the first terms left out are below u.
#[inline]
pub fn small_turn(x: Real) -> (Real, Real) {
    let z = x * x;
    let c = 1.0 - z * (1.0 / 2.0 - z * (1.0 / 24.0 - z * (1.0 / 720.0 - z * (1.0 / 40320.0 - z * (1.0 / 3628800.0 - z / 479001600.0)))));
    let s = x
        * (1.0
            - z * (1.0 / 6.0
                - z * (1.0 / 120.0 - z * (1.0 / 5040.0 - z * (1.0 / 362880.0 - z * (1.0 / 39916800.0 - z / 6227020800.0))))));
    (c, s)
}
