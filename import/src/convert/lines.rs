//! Joint axes as lines, and the rows that their common normals make.
//!
//! Line k goes through a point along a unit vector u_k. Line 0 is the z axis of the base, line n + 1 the z axis of the end effector.
//! x_k is the unit normal from line k to line k + 1, f_k its foot on k, f'_{k+1} its foot on k + 1:
//!
//! ```text
//! a_k = (f'_{k+1} - f_k)·x_k      alpha_k = atan2(x_k·(u_k × u_{k+1}), u_k·u_{k+1})
//! d_k = (f_k - f'_k)·u_k          theta_k = atan2(u_k·(x_{k-1} × x_k), x_{k-1}·x_k)
//! ```
//!
//! If lines meet, x_k is ± the cross product with theta_k in (-pi/2, pi/2]. If they are parallel, d_k = 0; if they coincide, theta_k = 0 as
//! well. A slide has only a direction: its line goes through f_k. Every test is exact.
//!
//! Source: J. Denavit and R. S. Hartenberg, *A Kinematic Notation for Lower-Pair Mechanisms Based on Matrices*, J. Appl. Mech. 22 (1955).

use std::cmp::Ordering;

use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::manipulator::Placement;

type Vector = [Number; 3];

/// A joint: its frame, whose origin the axis passes through, is `before` in the link frame before it; the link frame is `after` in it.
pub(super) struct Axis {
    pub(super) before: Placement,
    pub(super) direction: Vector,
    pub(super) after: Placement,
    pub(super) prismatic: bool,
}

/// The data of line k.
pub(super) struct Normal {
    /// a_k.
    pub(super) length: Number,
    /// Sine and cosine of alpha_k.
    pub(super) twist: (Number, Number),
    /// d_k; of the base the coordinate of f_0, of the end effector that of its origin from f'.
    pub(super) offset: Number,
    /// Sine and cosine of theta_k. Base and end effector have the angle from x_0 to the base's x axis, and from x_n to its own.
    pub(super) turn: (Number, Number),
    /// In the joint's frame, the frames with x along x_k: at f_k with z along line k, and at f'_{k+1} with z along line k + 1.
    pub(super) near: Placement,
    pub(super) far: Placement,
}

/// Lines 0 to n + 1; `None` if a number is too complex.
pub(super) fn normals(joints: &[Axis], tool: &Placement) -> Option<Vec<Normal>> {
    let z = || [Number::zero(), Number::zero(), Number::one()];
    let n = joints.len();
    let mut found = Vec::new();
    // x_{k-1}, the point of line k and the coordinate of f'_k on it, in the frame of joint k.
    let (mut x_before, mut point, mut coordinate) = ([Number::one(), Number::zero(), Number::zero()], zero(), Number::zero());
    for k in 0..=n {
        let u = if k == 0 { z() } else { joints[k - 1].direction.clone() };
        let after = if k == 0 { Placement::identity() } else { joints[k - 1].after.clone() };
        let (step, next) = match joints.get(k) {
            Some(joint) => (after.then(&joint.before), joint.direction.clone()),
            None => (after.then(tool), z()),
        };
        let slides = joints.get(k).is_some_and(|joint| joint.prismatic);
        let v = step.direction(&next);
        let origin = numbers(&step.translation)?;
        let w = minus(&origin, &point);
        let cross_product = cross(&u, &v);
        let parallel = cross_product.iter().all(is_zero);
        // Of the two normals of lines that meet the one that theta is in (-pi/2, pi/2] for.
        let chosen = |x: Vector| {
            let (sine, cosine) = (dot(&u, &cross(&x_before, &x)), dot(&x_before, &x));
            let keep = match cosine.sign() {
                Ordering::Equal => sine.sign() == Ordering::Greater,
                sign => sign == Ordering::Greater,
            };
            if keep {
                x
            } else {
                x.map(|e| -&e)
            }
        };
        let mut along = coordinate.clone();
        let mut length = Number::zero();
        let x = if parallel {
            let aside = minus(&w, &scaled(&u, &dot(&w, &u)));
            if slides || aside.iter().all(is_zero) {
                x_before.clone()
            } else {
                let x = unit(&aside)?;
                length = dot(&w, &x);
                x
            }
        } else if slides {
            chosen(unit(&cross_product)?)
        } else {
            let square = dot(&cross_product, &cross_product);
            along = dot(&cross(&w, &v), &cross_product).checked_div(&square)?;
            let apart = dot(&w, &cross_product);
            let x = unit(&cross_product)?;
            match apart.sign() {
                Ordering::Equal => chosen(x),
                sign => {
                    let x = if sign == Ordering::Less { x.map(|e| -&e) } else { x };
                    length = dot(&w, &x);
                    x
                }
            }
        };
        let foot = plus(&point, &scaled(&u, &along));
        let other = plus(&foot, &scaled(&x, &length));
        found.push(Normal {
            twist: (dot(&x, &cross_product), dot(&u, &v)),
            offset: along.minus(&coordinate),
            turn: (dot(&u, &cross(&x_before, &x)), dot(&x_before, &x)),
            near: frame(&x, &u, &foot),
            far: frame(&x, &v, &other),
            length,
        });
        // On to the frame of the next joint.
        let back = step.inverse();
        x_before = back.direction(&x);
        let there = numbers(&back.point(&other.map(Polynomial::from)))?;
        (point, coordinate) = match slides {
            true => (there, Number::zero()),
            false => (zero(), dot(&there, &next)),
        };
    }
    let x = [Number::one(), Number::zero(), Number::zero()];
    found.push(Normal {
        length: Number::zero(),
        twist: (Number::zero(), Number::one()),
        offset: -&coordinate,
        turn: (dot(&z(), &cross(&x_before, &x)), dot(&x_before, &x)),
        near: Placement::identity(),
        far: Placement::identity(),
    });
    Some(found)
}

fn frame(x: &Vector, z: &Vector, origin: &Vector) -> Placement {
    let y = cross(z, x);
    Placement {
        rotation: std::array::from_fn(|i| [x[i].clone(), y[i].clone(), z[i].clone()]),
        translation: origin.each_ref().map(|x| Polynomial::from(x.clone())),
    }
}

fn numbers(lengths: &[Polynomial; 3]) -> Option<Vector> {
    let [x, y, z] = lengths.each_ref().map(Polynomial::as_number);
    Some([x?, y?, z?])
}

fn zero() -> Vector {
    std::array::from_fn(|_| Number::zero())
}

fn is_zero(number: &Number) -> bool {
    number.sign() == Ordering::Equal
}

fn dot(a: &Vector, b: &Vector) -> Number {
    (0..3).fold(Number::zero(), |sum, k| sum.plus(&a[k].times(&b[k])))
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        a[j].times(&b[k]).minus(&a[k].times(&b[j]))
    })
}

/// Whether two directions are parallel or opposite.
pub(super) fn are_parallel(a: &Vector, b: &Vector) -> bool {
    cross(a, b).iter().all(is_zero)
}

fn plus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| a[i].plus(&b[i]))
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| a[i].minus(&b[i]))
}

fn scaled(a: &Vector, by: &Number) -> Vector {
    a.each_ref().map(|x| x.times(by))
}

/// The unit vector along one other than 0.
fn unit(vector: &Vector) -> Option<Vector> {
    let given: Vec<usize> = (0..3).filter(|&k| !is_zero(&vector[k])).collect();
    if let [only] = given[..] {
        let one = if vector[only].sign() == Ordering::Less { Number::from(-1) } else { Number::one() };
        return Some(std::array::from_fn(|k| if k == only { one.clone() } else { Number::zero() }));
    }
    let length = dot(vector, vector).sqrt()?;
    let [x, y, z] = vector.each_ref().map(|x| x.checked_div(&length));
    Some([x?, y?, z?])
}
